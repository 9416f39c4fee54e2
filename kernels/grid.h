// The hash grid that photons are sorted into. Cells are cubes a little larger than 2 r_max, so that the sphere around a visible
// point touches at most two in each direction, rounding included. A run of cells along x falls into consecutive buckets, which one range of
// the sorted photons covers.
#ifndef TRISTIM_GRID_H
#define TRISTIM_GRID_H

#include "config.h"
#include "shared_types.h"

#define BUCKET_BITS (2 * RADIX_BITS)
#define BUCKET_COUNT (1u << BUCKET_BITS)
#define BUCKET_MASK (BUCKET_COUNT - 1u)

// With what radius to search for photons around a point of a triangle of this extent if `wanted` is the schedule's.
float search_radius(float wanted, float extent) {
    return max(wanted, max(SMALLEST_RELATIVE_RADIUS * extent, SMALLEST_RADIUS));
}

// 1 / edge of a cell. largest_radius holds the bits of the largest search radius of the pass's visible points, 0 if it has
// none (then nothing is looked up, and any scale will do).
float cell_scale(const global uint* largest_radius) {
    return largest_radius[0] != 0u ? 0.4999f / as_float(largest_radius[0]) : 1.0f;
}

int3 cell_of(float3 point, const global SceneConstants* c, float scale) {
    return convert_int3_rtn((point - (float3)(c->centre_x, c->centre_y, c->centre_z)) * scale);
}

// Of the row of cells with these y and z; cell x is in bucket (row_bucket + x) mod BUCKET_COUNT. Multipliers from Teschner et
// al. 2003, "Optimized Spatial Hashing", with a final mix so that near rows fall far apart.
uint row_bucket(int y, int z) {
    uint h = (uint)y * 19349663u ^ (uint)z * 83492791u;
    h ^= h >> 15;
    h *= 0x2c1b3c6du;
    return h ^ h >> 13;
}

#endif
