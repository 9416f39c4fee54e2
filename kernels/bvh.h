// Ray traversal of the BVH (layout in shared_types.h), one ray per work-item, BVH_WIDTH boxes or triangles at a time.
// Watertight: triangles by Woop, Benthin & Wald 2013 ("Watertight Ray/Triangle Intersection"), boxes widened by the
// builder in proportion to the triangles' coordinates and here in proportion to the ray's origin, so that rounding never
// hides a box whose triangle is hit. Both sides of a triangle are hit.
//
// t is in units of |direction|, which should be about 1: components below BVH_SMALLEST_DIRECTION are raised to it, so
// that no infinity or NaN appears in the slab test.
#ifndef TRISTIM_BVH_H
#define TRISTIM_BVH_H

#include "config.h"
#include "multiply_add.h"
#include "shared_types.h"

#define BVH_SMALLEST_DIRECTION 1e-18f

// Half a unit in the last place of 1, and how many of them times the largest coordinate a box is widened by. Slabs: 5
// for the reciprocal (OpenCL allows 2.5 ulp), 3 for the products and the sum; triangles: 6 for translating and shearing
// a vertex (Woop et al. 2013, section 3). The builder (host/bvh/binary_tree.cpp) adds the same multiple of the
// triangles' coordinates.
#define BVH_ROUNDING 5.9604645e-8f
#define BVH_PADDING (16.0f * BVH_ROUNDING)

// By how much of the largest coordinate a ray's origin is moved off the surface that it leaves: see offset_from_triangle.
#define BVH_LEAVING (32.0f * BVH_ROUNDING)

// Names of vector types and built-in functions of BVH_WIDTH lanes: BVH_LANES(vload) is vload8.
#define BVH_JOIN(name, width) name##width
#define BVH_JOIN_EXPANDED(name, width) BVH_JOIN(name, width)
#define BVH_LANES(name) BVH_JOIN_EXPANDED(name, BVH_WIDTH)
typedef BVH_LANES(float) BvhFloats;
typedef BVH_LANES(int) BvhInts;

// Where a ray hit: point = (1-u-v) v0 + u v1 + v v2. triangle = -1 if it hit nothing.
typedef struct Hit {
    float t; // t_max if it hit nothing
    int triangle;
    float u, v;
} Hit;

// What the traversal needs of a ray, computed once.
typedef struct BvhRay {
    float3 inverse;     // 1 / direction
    float3 entry, exit; // -origin / direction, moved outwards for planes where the ray enters and leaves a box
    int3 entry_row;     // where in a BvhNode, in floats, the planes lie through which the ray enters a box
    int3 axis;          // rows of a vertex's coordinates; z is the direction's largest component
    float3 origin;      // in the order of axis
    float3 shear;       // Woop et al. 2013, section 3.2
} BvhRay;

float bvh_component(float3 v, int axis) {
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

BvhRay bvh_prepare_ray(float3 origin, float3 direction) {
    BvhRay ray;
    const float3 size = fabs(direction);
    const float3 clamped = copysign(max(size, (float3)(BVH_SMALLEST_DIRECTION)), direction);
    ray.inverse = 1.0f / clamped;
    const float3 reach = fabs(origin);
    const float3 widening = copysign((float3)(BVH_PADDING * max(max(reach.x, reach.y), reach.z)), direction);
    ray.entry = -(origin + widening) * ray.inverse;
    ray.exit = -(origin - widening) * ray.inverse;
    ray.entry_row.x = BVH_WIDTH * (signbit(direction.x) ? BVH_HIGH : BVH_LOW);
    ray.entry_row.y = BVH_WIDTH * (signbit(direction.y) ? BVH_HIGH + 1 : BVH_LOW + 1);
    ray.entry_row.z = BVH_WIDTH * (signbit(direction.z) ? BVH_HIGH + 2 : BVH_LOW + 2);

    ray.axis.z = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
    ray.axis.x = ray.axis.z == 2 ? 0 : ray.axis.z + 1;
    ray.axis.y = ray.axis.x == 2 ? 0 : ray.axis.x + 1;
    ray.origin = (float3)(bvh_component(origin, ray.axis.x), bvh_component(origin, ray.axis.y),
                          bvh_component(origin, ray.axis.z));
    ray.shear.z = bvh_component(ray.inverse, ray.axis.z);
    ray.shear.x = bvh_component(direction, ray.axis.x) * ray.shear.z;
    ray.shear.y = bvh_component(direction, ray.axis.y) * ray.shear.z;
    return ray;
}

// One byte of each lane's comparison result, 0 or 1.
ulong bvh_lane_mask(BvhInts condition) {
#if BVH_WIDTH == 8
    return as_ulong(convert_char8(condition)) & 0x0101010101010101UL;
#elif BVH_WIDTH == 4
    return as_uint(convert_char4(condition)) & 0x01010101u;
#else
    return as_ushort(convert_char2(condition)) & 0x0101u;
#endif
}

// The lowest lane of a mask that is not zero.
int bvh_first_lane(ulong mask) {
    return (int)(popcount((mask - 1) & ~mask) >> 3);
}

// The children of a node that the ray meets before t_max; *entry_t is where it enters each.
ulong bvh_intersect_boxes(const global BvhNode* node, const BvhRay* ray, float t_max, BvhFloats* entry_t) {
    const global float* rows = (const global float*)node;
    const BvhFloats inverse_x = ray->inverse.x, inverse_y = ray->inverse.y, inverse_z = ray->inverse.z;
    const BvhFloats entry_x = multiply_add(BVH_LANES(vload)(0, rows + ray->entry_row.x), inverse_x, (BvhFloats)(ray->entry.x));
    const BvhFloats entry_y = multiply_add(BVH_LANES(vload)(0, rows + ray->entry_row.y), inverse_y, (BvhFloats)(ray->entry.y));
    const BvhFloats entry_z = multiply_add(BVH_LANES(vload)(0, rows + ray->entry_row.z), inverse_z, (BvhFloats)(ray->entry.z));
    const int low_and_high = BVH_WIDTH * (BVH_LOW + BVH_HIGH); // less an axis's one row: its other
    const BvhFloats exit_x =
        multiply_add(BVH_LANES(vload)(0, rows + (low_and_high - ray->entry_row.x)), inverse_x, (BvhFloats)(ray->exit.x));
    const BvhFloats exit_y = multiply_add(BVH_LANES(vload)(0, rows + (low_and_high + 2 * BVH_WIDTH - ray->entry_row.y)), inverse_y,
                                 (BvhFloats)(ray->exit.y));
    const BvhFloats exit_z = multiply_add(BVH_LANES(vload)(0, rows + (low_and_high + 4 * BVH_WIDTH - ray->entry_row.z)), inverse_z,
                                 (BvhFloats)(ray->exit.z));
    *entry_t = max(max(entry_x, entry_y), max(entry_z, (BvhFloats)(0.0f)));
    const BvhFloats exit_t = min(min(exit_x, exit_y), min(exit_z, (BvhFloats)(t_max)));
    return bvh_lane_mask(*entry_t <= exit_t);
}

// A leaf's triangles seen along the ray, edge functions (U, V, W) made non-negative where the triangle is hit.
typedef struct BvhEdges {
    BvhFloats v, w, determinant, scaled_t;
    ulong hits;
} BvhEdges;

// a_x b_y - a_y b_x to within two roundings by Kahan's algorithm (Jeannerod, Louvet & Muller 2013, "Further Analysis of
// Kahan's Algorithm for the Accurate Computation of 2 × 2 Determinants"): its sign is that of the exact value, so that
// the triangle on the edge's other side gets the opposite one, and the weights of the vertices are right even where the
// triangle is seen so edge-on, or is so much a needle, that plain products would leave nothing but rounding. Without
// contraction, so that it is no worse than plain products on a device whose fma() rounds twice.
BvhFloats bvh_edge_function(BvhFloats a_x, BvhFloats a_y, BvhFloats b_x, BvhFloats b_y) {
#pragma OPENCL FP_CONTRACT OFF
    const BvhFloats right = a_y * b_x;
    const BvhFloats lost = fused_multiply_add(-a_y, b_x, right);
    const BvhFloats difference = fused_multiply_add(a_x, b_y, -right);
    return difference + lost;
}

// Woop, Benthin & Wald 2013, listing in appendix A, without the division and without the double-precision fallback: an
// edge function of zero counts as inside on both sides.
BvhEdges bvh_intersect_triangles(const global BvhLeaf* leaf, const BvhRay* ray, float t_max) {
    const global float* rows_x = (const global float*)leaf + BVH_WIDTH * ray->axis.x;
    const global float* rows_y = (const global float*)leaf + BVH_WIDTH * ray->axis.y;
    const global float* rows_z = (const global float*)leaf + BVH_WIDTH * ray->axis.z;
    const BvhFloats a_z = BVH_LANES(vload)(0, rows_z) - ray->origin.z;
    const BvhFloats b_z = BVH_LANES(vload)(3, rows_z) - ray->origin.z;
    const BvhFloats c_z = BVH_LANES(vload)(6, rows_z) - ray->origin.z;
    const BvhFloats a_x = fused_multiply_add(a_z, (BvhFloats)(-ray->shear.x), BVH_LANES(vload)(0, rows_x) - ray->origin.x);
    const BvhFloats a_y = fused_multiply_add(a_z, (BvhFloats)(-ray->shear.y), BVH_LANES(vload)(0, rows_y) - ray->origin.y);
    const BvhFloats b_x = fused_multiply_add(b_z, (BvhFloats)(-ray->shear.x), BVH_LANES(vload)(3, rows_x) - ray->origin.x);
    const BvhFloats b_y = fused_multiply_add(b_z, (BvhFloats)(-ray->shear.y), BVH_LANES(vload)(3, rows_y) - ray->origin.y);
    const BvhFloats c_x = fused_multiply_add(c_z, (BvhFloats)(-ray->shear.x), BVH_LANES(vload)(6, rows_x) - ray->origin.x);
    const BvhFloats c_y = fused_multiply_add(c_z, (BvhFloats)(-ray->shear.y), BVH_LANES(vload)(6, rows_y) - ray->origin.y);

    const BvhFloats u = bvh_edge_function(c_x, c_y, b_x, b_y);
    const BvhFloats v = bvh_edge_function(a_x, a_y, c_x, c_y);
    const BvhFloats w = bvh_edge_function(b_x, b_y, a_x, a_y);
    const BvhFloats determinant = u + v + w;
    const BvhInts sign = BVH_LANES(as_int)(determinant) & (BvhInts)(0x80000000);
    const BvhFloats t = (u * a_z + v * b_z + w * c_z) * ray->shear.z;

    BvhEdges edges;
    edges.v = BVH_LANES(as_float)(BVH_LANES(as_int)(v) ^ sign);
    edges.w = BVH_LANES(as_float)(BVH_LANES(as_int)(w) ^ sign);
    edges.determinant = fabs(determinant);
    edges.scaled_t = BVH_LANES(as_float)(BVH_LANES(as_int)(t) ^ sign);
    const BvhFloats smallest = min(BVH_LANES(as_float)(BVH_LANES(as_int)(u) ^ sign), min(edges.v, edges.w));
    edges.hits =
        bvh_lane_mask((smallest >= 0.0f) & (edges.scaled_t > 0.0f) & (edges.scaled_t < t_max * edges.determinant));
    return edges;
}

// Replaces *hit by the leaf's nearest hit if that is nearer.
void bvh_closest_in_leaf(const global BvhLeaf* leaf, const BvhRay* ray, Hit* hit) {
    const BvhEdges edges = bvh_intersect_triangles(leaf, ray, hit->t);
    if (edges.hits == 0)
        return;
    const BvhFloats scale = 1.0f / edges.determinant;
    float t[BVH_WIDTH], u[BVH_WIDTH], v[BVH_WIDTH];
    BVH_LANES(vstore)(edges.scaled_t * scale, 0, t);
    BVH_LANES(vstore)(edges.v * scale, 0, u);
    BVH_LANES(vstore)(edges.w * scale, 0, v);
    for (ulong hits = edges.hits; hits != 0; hits &= hits - 1) {
        const int lane = bvh_first_lane(hits);
        if (t[lane] < hit->t) {
            hit->t = t[lane];
            hit->triangle = leaf->id[lane];
            hit->u = u[lane];
            hit->v = v[lane];
        }
    }
}

// The nearest hit at 0 < t < t_max.
Hit bvh_closest_hit(const global BvhNode* nodes, const global BvhLeaf* leaves, float3 origin, float3 direction,
                    float t_max) {
    const BvhRay ray = bvh_prepare_ray(origin, direction);
    Hit hit;
    hit.t = t_max;
    hit.triangle = -1;
    hit.u = 0.0f;
    hit.v = 0.0f;

    // What is left to visit, the nearest of each node's children on top: the bits of the (non-negative) distance above
    // the child reference, so that entries compare as integers. The nearest child of the current node never goes there.
    ulong stack[BVH_STACK_SIZE];
    int top = 0;
    int child = 0;
    for (;;) {
        const global BvhNode* node = nodes + child;
        BvhFloats entry_t;
        ulong hits = 0;
        if (child >= 0)
            hits = bvh_intersect_boxes(node, &ray, hit.t, &entry_t);
        else
            bvh_closest_in_leaf(leaves + ~child, &ray, &hit);
        if (hits == 0) {
            ulong entry;
            do {
                if (top == 0)
                    return hit;
                entry = stack[--top];
            } while (as_float((uint)(entry >> 32)) > hit.t);
            child = (int)(uint)entry;
            continue;
        }
        int lane = bvh_first_lane(hits);
        child = node->child[lane];
        hits &= hits - 1;
        if (hits == 0)
            continue;
        uint distances[BVH_WIDTH];
        BVH_LANES(vstore)(BVH_LANES(as_uint)(entry_t), 0, distances);
        ulong nearest = ((ulong)distances[lane] << 32) | (uint)child;
        const int bottom = top;
        for (; hits != 0; hits &= hits - 1) {
            lane = bvh_first_lane(hits);
            const ulong other = ((ulong)distances[lane] << 32) | (uint)node->child[lane];
            const ulong pushed = max(nearest, other);
            nearest = min(nearest, other);
            int place = top++;
            for (; place > bottom && stack[place - 1] < pushed; --place)
                stack[place] = stack[place - 1];
            stack[place] = pushed;
        }
        child = (int)(uint)nearest;
    }
}

// Whether anything is hit at 0 < t < t_max. The nearest child of a node is visited first, the others in any order.
bool bvh_any_hit(const global BvhNode* nodes, const global BvhLeaf* leaves, float3 origin, float3 direction,
                 float t_max) {
    const BvhRay ray = bvh_prepare_ray(origin, direction);
    int stack[BVH_STACK_SIZE];
    int top = 0;
    int child = 0;
    for (;;) {
        const global BvhNode* node = nodes + child;
        BvhFloats entry_t;
        ulong hits = 0;
        if (child >= 0)
            hits = bvh_intersect_boxes(node, &ray, t_max, &entry_t);
        else if (bvh_intersect_triangles(leaves + ~child, &ray, t_max).hits != 0)
            return true;
        if (hits == 0) {
            if (top == 0)
                return false;
            child = stack[--top];
            continue;
        }
        int lane = bvh_first_lane(hits);
        child = node->child[lane];
        hits &= hits - 1;
        if (hits == 0)
            continue;
        float distances[BVH_WIDTH];
        BVH_LANES(vstore)(entry_t, 0, distances);
        float nearest = distances[lane];
        for (; hits != 0; hits &= hits - 1) {
            lane = bvh_first_lane(hits);
            const int other = node->child[lane];
            const bool nearer = distances[lane] < nearest;
            stack[top++] = nearer ? child : other;
            child = nearer ? other : child;
            nearest = nearer ? distances[lane] : nearest;
        }
    }
}

// The point p of a triangle moved off it, to the side that the geometric normal (unit) points to, so that a ray from
// there does not meet the triangle again. p should be interpolated from the vertices with the hit's u and v, not computed
// from origin and t; `extent` is the vertices' largest absolute coordinate, or that of the ray's other end counted from
// p if that is more. The steps from the vertices to an intersection round by at most 17 BVH_ROUNDING of it (six roundings
// of vectors up to twice as long, across the ray and in two coordinates), those to p by about 10.
float3 offset_from_triangle(float3 p, float3 geometric_normal, float extent) {
    return p + BVH_LEAVING * extent * geometric_normal;
}

#endif
