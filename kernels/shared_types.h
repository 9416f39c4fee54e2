// Structs that host and device share. Plain 4-byte floats and ints only: a vector type would bring padding that differs
// between the two. The host checks sizes and offsets with static_assert, the tests ask the device for its own.
#ifndef TRISTIM_SHARED_TYPES_H
#define TRISTIM_SHARED_TYPES_H

#ifdef __OPENCL_VERSION__
typedef uint tristim_uint;
#else
#include <cstdint>
namespace tristim {
typedef std::uint32_t tristim_uint;
#endif

// Eight children in structure-of-arrays form, 256 bytes. child >= 0 is a node, child < 0 is ~leaf. Empty slots have
// bounds low = +1e18, high = -1e18.
typedef struct BvhNode {
    float low_x[8], low_y[8], low_z[8];
    float high_x[8], high_y[8], high_z[8];
    int child[8];
    int unused[8];
} BvhNode;

// Eight triangles in structure-of-arrays form, 320 bytes. Empty lanes have id = -1 and degenerate vertices.
typedef struct BvhLeaf {
    float v0_x[8], v0_y[8], v0_z[8];
    float v1_x[8], v1_y[8], v1_z[8];
    float v2_x[8], v2_y[8], v2_z[8];
    int id[8];
} BvhLeaf;

// A ray for the stand-alone traversal kernel, 32 bytes. Hits lie at 0 < t < t_max in units of |direction|, which should be
// about 1.
typedef struct Ray {
    float origin_x, origin_y, origin_z;
    float t_max;
    float direction_x, direction_y, direction_z;
    float unused;
} Ray;

// Where a ray hit, 16 bytes: point = (1-u-v) v0 + u v1 + v v2; triangle = -1 if it hit nothing.
typedef struct RayHit {
    float t;
    int triangle;
    float u, v;
} RayHit;

#ifndef __OPENCL_VERSION__
static_assert(sizeof(BvhNode) == 256 && sizeof(BvhLeaf) == 320);
static_assert(sizeof(Ray) == 32 && sizeof(RayHit) == 16);
} // namespace tristim
#endif

#endif
