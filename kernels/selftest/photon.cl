// Random numbers, tests for values that are not finite, search radii and the points of photons, for
// host/selftest/photon_cases.cpp.
#include "finite.h"
#include "grid.h"
#include "scene.h"

// Each item hashes and draws from its own coordinates: eight uints of pcg4d and random_step, then eight dimensions of Sobol'
// numbers, as bits.
kernel void random_numbers(const global uint4* coordinates, const global uint* table, global uint8* hashed, global uint8* drawn) {
    const size_t i = get_global_id(0);
    const uint4 c = coordinates[i];
    const uint4 a = pcg4d(c);
    const float4 r = random4(c.w, c.z, c.x, c.y);
    hashed[i] = (uint8)(a, as_uint(random_step(c.x, c.y)), as_uint(r.x), as_uint(r.y), as_uint(unit_float(c.z)));
    drawn[i] = as_uint8(sobol8(table, c.x, (uint8)(c, a)));
}

// Values that arithmetic makes, and what is_finite says of them and of the inputs.
kernel void finite_values(const global float2* inputs, global float4* values, global int4* finite, global int2* of_inputs) {
    const size_t i = get_global_id(0);
    const float2 v = inputs[i];
    const float4 made = (float4)(v.x + v.y, v.x * v.y, v.x / v.y, sqrt(v.x));
    values[i] = made;
    finite[i] = (int4)(is_finite(made.x), is_finite(made.y), is_finite(made.z), is_finite(made.w));
    of_inputs[i] = (int2)(is_finite(v.x), is_finite3(v.xyx));
}

// x: the initial radius, y: radius_scale, z: the triangle's extent.
kernel void radii(const global float4* inputs, global float* radii) {
    const size_t i = get_global_id(0);
    radii[i] = search_radius(inputs[i].x * inputs[i].y, inputs[i].z);
}

// Where rays from origins.xyz straight down -z meet the first triangle, which is the leaf's.
kernel void points_below(const global BvhLeaf* leaf, const global Triangle* triangle, const global float4* origins,
                         global float4* points) {
    const size_t i = get_global_id(0);
    const BvhRay ray = bvh_prepare_ray(origins[i].xyz, (float3)(0.0f, 0.0f, -1.0f));
    Hit hit = {INFINITE_DISTANCE, -1, 0.0f, 0.0f};
    bvh_closest_in_leaf(leaf, &ray, &hit);
    Scene scene;
    scene.triangles = triangle;
    const bool met = hit.triangle == 0;
    hit.triangle = 0;
    points[i] = (float4)(make_interaction(&scene, &hit).point, met ? 1.0f : 0.0f);
}
