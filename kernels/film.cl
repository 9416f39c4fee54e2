// Step 6: the pixels' running sums of XYZ and of its square, in three floats each and two (never built with relaxed math, which would
// undo the compensation), and the search radius of each pixel.
#include "config.h"
#include "shared_types.h"
#include "sampling.h"
#include "finite.h"

// a + b = *sum + *lost, exactly (Knuth 1997, TAOCP vol. 2, section 4.2.2, theorem B). X, Y and Z at once: half the time of one after
// the other.
void two_sum(float3 a, float3 b, float3* sum, float3* lost) {
#pragma OPENCL FP_CONTRACT OFF
    const float3 s = a + b;
    const float3 b_part = s - a;
    *lost = (a - (s - b_part)) + (b - b_part);
    *sum = s;
}

// The same in half the time where |a| >= |b| (Dekker's, theorem C); else *lost is off by a rounding of b at most.
void fast_two_sum(float3 a, float3 b, float3* sum, float3* lost) {
#pragma OPENCL FP_CONTRACT OFF
    const float3 s = a + b;
    *lost = b - (s - a);
    *sum = s;
}

// Adds to high + low with the precision of two floats. The sum of the low parts is kept below half a unit of the high one; it would grow
// as a plain sum otherwise.
void add_compensated(float3* high, float3* low, float3 value) {
    float3 sum, lost;
    two_sum(*high, value, &sum, &lost);
    fast_two_sum(sum, *low + lost, high, low);
}

// Adds to the sum of three floats with the precision of all three, some 72 bits: so the sum of many samples, rounded to a float, does
// not depend on the order in which they came, or on how passes were shared out among films that are added up later. Only a sum
// within 2^-48 of its size of the border between two floats could tell.
void add_to_sum(float3* high, float3* middle, float3* low, float3 value) {
    float3 sum, second, third, lost;
    two_sum(*high, value, &sum, &lost);
    two_sum(*middle, lost, &second, &third);
    third += *low;
    fast_two_sum(sum, second, high, &second);
    fast_two_sum(second, third, middle, low);
}

// One work-item per pixel, before the first pass.
kernel void film_clear(const global float* radius0, global FilmPixel* film) {
    const uint pixel = (uint)get_global_id(0);
    global FilmPixel* f = film + pixel;
    for (int c = 0; c < 3; ++c)
        f->sum_high[c] = f->sum_middle[c] = f->sum_low[c] = f->square_high[c] = f->square_low[c] = 0.0f;
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
    float3 high = (float3)(f->statistics_radius, f->statistics_count, 0.0f);
    float3 low = (float3)(f->statistics_radius_low, f->statistics_count_low, 0.0f);
    add_compensated(&high, &low, (float3)(-step, alpha * found, 0.0f));
    f->statistics_radius = high.x;
    f->statistics_radius_low = low.x;
    f->statistics_count = high.y;
    f->statistics_count_low = low.y;
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
    float3 high = vload3(0, f->sum_high), middle = vload3(0, f->sum_middle), low = vload3(0, f->sum_low);
    add_to_sum(&high, &middle, &low, xyz);
    vstore3(high, 0, f->sum_high);
    vstore3(middle, 0, f->sum_middle);
    vstore3(low, 0, f->sum_low);
    high = vload3(0, f->square_high);
    low = vload3(0, f->square_low);
    const int3 has_square = fabs(xyz) <= LARGEST_SQUARED_SAMPLE && high < INFINITY;
    add_compensated(&high, &low, xyz * xyz);
    vstore3(select((float3)(INFINITY), high, has_square), 0, f->square_high);
    vstore3(select((float3)(0.0f), low, has_square), 0, f->square_low);
}

// One work-item per pixel.
kernel void film_add(const global VisiblePoint* visible_points, const global float4* gathered_flux, float alpha,
                     global FilmPixel* film) {
    const uint pixel = (uint)get_global_id(0);
    const VisiblePoint point = visible_points[pixel];
    add_sample(film + pixel, &point, point.slot != SLOT_NONE ? gathered_flux[pixel] : (float4)(0.0f), alpha);
}
