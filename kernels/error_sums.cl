// What errors are estimated from (host/render/error_estimate.h), beside the film: sums over groups of passes, whose spread tells the
// noise, and what the photons' two densities tell of the bias. All are plain sums, so that films that are added up later add up here
// too.
#include "shared_types.h"
#include "sampling.h"
#include "finite.h"

void add_to_planes(global float* sums, uint pixels, uint pixel, int plane, float3 value) {
    global float* sum = sums + (size_t)plane * pixels + pixel;
    sum[0] += value.x;
    sum[pixels] += value.y;
    sum[2u * (size_t)pixels] += value.z;
}

// One work-item per pixel, after the gather. `groups` holds ERROR_GROUP_BITS for each level, the first one lowest: the group of this
// pass. sums has ERROR_PLANES rows of `pixels` floats.
kernel void error_add(const global VisiblePoint* visible_points, const global float4* gathered_flux, const global float4* inner_flux,
                      uint groups, uint pixels, global float* sums) {
    const uint pixel = (uint)get_global_id(0);
    const VisiblePoint point = visible_points[pixel];
    float3 xyz = (float3)(point.direct_x, point.direct_y, point.direct_z);
    float3 bias = 0.0f;
    if (point.slot != SLOT_NONE) {
        const float area = PI * point.radius * point.radius;
        const float3 gathered = gathered_flux[pixel].xyz;
        xyz += gathered / area;
        // Twice the density within the radius less that within the disc of half its area.
        bias = 2.0f * (gathered - 2.0f * inner_flux[pixel].xyz) / area;
    }
    if (!all(fabs(xyz) <= LARGEST_SAMPLE))
        return;
    for (int level = 0; level < ERROR_LEVELS; ++level) {
        const int group = (int)(groups >> (level * ERROR_GROUP_BITS)) & (ERROR_GROUPS - 1);
        add_to_planes(sums, pixels, pixel, 3 * (level * ERROR_GROUPS + group), xyz);
    }
    if (point.slot != SLOT_NONE && all(fabs(bias) <= LARGEST_SQUARED_SAMPLE)) {
        add_to_planes(sums, pixels, pixel, ERROR_BIAS_PLANE, bias);
        add_to_planes(sums, pixels, pixel, ERROR_BIAS_PLANE + 3, bias * bias);
    }
}
