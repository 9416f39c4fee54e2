// Step 6: the pixels' running sums of XYZ and of its square, in two floats each (never built with relaxed math, which would
// undo the compensation), and the search radius of each pixel.
#include "config.h"
#include "shared_types.h"
#include "sampling.h"

// Samples beyond this count as not finite: 2^32 of them still add up to a float.
#define LARGEST_SAMPLE 0x1p95f
// And the same for squares.
#define LARGEST_SQUARED_SAMPLE 0x1p47f

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
    f->statistics_radius_low = f->statistics_count = f->statistics_count_low = 0.0f;
    f->camera_rays = f->shadow_rays = f->ray_carries = 0;
}

// One work-item per pixel, for --radius statistics: the bits of the largest radius of a visible point in the pass. Positive floats are ordered as their
// bits are. largest_radius[0] starts from 0.
kernel void film_largest_radius(const global VisiblePoint* visible_points, global uint* largest_radius) {
    const global VisiblePoint* point = visible_points + get_global_id(0);
    const uint bits = as_uint(point->radius);
    if (point->slot != SLOT_NONE && bits > largest_radius[0])
        atomic_max(largest_radius, bits);
}

// --radius statistics: Hachisuka et al. 2008, equations 7 to 9, for M new photons: r² ← r² (N + αM)/(N + M), N ← N + αM. In a
// million passes r shrinks by parts too small for a float each, so what it loses is computed on its own, r (1 - √(1 - x)), and
// taken off a compensated r.
void shrink_radius(global FilmPixel* f, float alpha, float found) {
    const float lost = (1.0f - alpha) * found / (f->statistics_count + found);  // share of r²
    const float step = f->statistics_radius * (lost / (1.0f + sqrt(1.0f - lost)));
    add_compensated(&f->statistics_radius, &f->statistics_radius_low, -step);
    add_compensated(&f->statistics_count, &f->statistics_count_low, alpha * found);
}

void count_rays(global uint* rays, uint more, global uint* carries, uint carry) {
    const uint sum = *rays + more;
    *carries += sum < more ? carry : 0u;
    *rays = sum;
}

// Adds a pass to a pixel. The flux τ of Hachisuka et al. 2008, equations 10 and 11, shrinks by the same factor as r², so τ/(π r²)
// is just the sum of flux/(π r_i²) over the passes, as with the global schedule.
void add_sample(global FilmPixel* f, const VisiblePoint* point, float4 gathered, float alpha) {
    count_rays(&f->camera_rays, point->camera_rays, &f->ray_carries, 1u);
    count_rays(&f->shadow_rays, point->shadow_rays, &f->ray_carries, 0x10000u);
    float3 xyz = (float3)(point->direct_x, point->direct_y, point->direct_z);
    if (point->slot != SLOT_NONE) {
        xyz += gathered.xyz / (PI * point->radius * point->radius);
#if RADIUS_STATISTICS
        if (gathered.w > 0.0f)
            shrink_radius(f, alpha, gathered.w);
#endif
    }
    if (!all(fabs(xyz) <= LARGEST_SAMPLE)) {
        ++f->rejected;
        return;
    }
    ++f->samples;
    const float values[3] = {xyz.x, xyz.y, xyz.z};
    for (int c = 0; c < 3; ++c) {
        add_compensated(&f->sum_high[c], &f->sum_low[c], values[c]);
        // Without branches, which would keep PoCL from vectorising over pixels: four times slower.
        const bool has_square = fabs(values[c]) <= LARGEST_SQUARED_SAMPLE && f->square_high[c] < INFINITY;
        add_compensated(&f->square_high[c], &f->square_low[c], values[c] * values[c]);
        f->square_high[c] = has_square ? f->square_high[c] : INFINITY;
        f->square_low[c] = has_square ? f->square_low[c] : 0.0f;
    }
}

// One work-item per pixel.
kernel void film_add(const global VisiblePoint* visible_points, const global float4* gathered_flux, float alpha,
                     global FilmPixel* film) {
    const uint pixel = (uint)get_global_id(0);
    const VisiblePoint point = visible_points[pixel];
    add_sample(film + pixel, &point, point.slot != SLOT_NONE ? gathered_flux[pixel] : (float4)(0.0f), alpha);
}
