// Step 6: the pixels' running sums of XYZ and of its square, in two floats each (never built with relaxed math, which would
// undo the compensation), and the search radius of each pixel.
#include "config.h"
#include "shared_types.h"
#include "sampling.h"

// Adds to high + low without loss: Knuth's TwoSum (Knuth 1997, TAOCP vol. 2, section 4.2.2, theorem B), then Dekker's of the two
// parts (theorem C), which keeps the low part below half a unit of the high one; it would grow as a plain sum otherwise.
void add_compensated(global float* high, global float* low, float value) {
#pragma OPENCL FP_CONTRACT OFF
    const float sum = *high + value;
    const float virtual_value = sum - *high;
    const float lost = (*high - (sum - virtual_value)) + (value - virtual_value);
    const float tail = *low + lost;
    *high = sum + tail;
    *low = tail - (*high - sum);
}

// One work-item per pixel, before the first pass.
kernel void film_clear(const global float* radius0, global FilmPixel* film) {
    const uint pixel = (uint)get_global_id(0);
    global FilmPixel* f = film + pixel;
    for (int c = 0; c < 3; ++c)
        f->sum_high[c] = f->sum_low[c] = f->square_high[c] = f->square_low[c] = 0.0f;
    f->samples = 0;
    f->rejected = 0;
    f->statistics_radius = radius0[pixel];
    f->statistics_count = 0.0f;
    f->camera_rays = 0;
    f->shadow_rays = 0;
}

// One work-item per pixel, for --radius statistics: the bits of the largest radius of a visible point in the pass. Positive floats are ordered as their
// bits are. largest_radius[0] starts from 0.
kernel void film_largest_radius(const global VisiblePoint* visible_points, global uint* largest_radius) {
    const global VisiblePoint* point = visible_points + get_global_id(0);
    const uint bits = as_uint(point->radius);
    if (point->slot != SLOT_NONE && bits > largest_radius[0])
        atomic_max(largest_radius, bits);
}

// One work-item per pixel: adds the pass. With RADIUS_STATISTICS the radius follows Hachisuka et al. 2008, equations 7 to 11:
// r² ← r² (N + αM)/(N + M), N ← N + αM. Their flux τ shrinks by the same factor as r², so τ/(π r²) is just the sum of
// flux/(π r_i²) over the passes, as in the other mode.
kernel void film_add(const global VisiblePoint* visible_points, const global float4* gathered_flux, float alpha,
                     global FilmPixel* film) {
    const uint pixel = (uint)get_global_id(0);
    const VisiblePoint point = visible_points[pixel];
    global FilmPixel* f = film + pixel;
    f->camera_rays += point.camera_rays;
    f->shadow_rays += point.shadow_rays;
    float3 xyz = (float3)(point.direct_x, point.direct_y, point.direct_z);
    if (point.slot != SLOT_NONE) {
        const float4 gathered = gathered_flux[pixel];
        xyz += gathered.xyz / (PI * point.radius * point.radius);
#if RADIUS_STATISTICS
        if (gathered.w > 0.0f) {
            const float kept = f->statistics_count + alpha * gathered.w;
            f->statistics_radius *= sqrt(kept / (f->statistics_count + gathered.w));
            f->statistics_count = kept;
        }
#endif
    }
    if (!all(isfinite(xyz))) {
        ++f->rejected;
        return;
    }
    ++f->samples;
    const float values[3] = {xyz.x, xyz.y, xyz.z};
    for (int c = 0; c < 3; ++c) {
        add_compensated(&f->sum_high[c], &f->sum_low[c], values[c]);
        add_compensated(&f->square_high[c], &f->square_low[c], values[c] * values[c]);
    }
}
