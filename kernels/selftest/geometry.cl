// Ray traversal, leaving surfaces and rays from and to area lights, for host/selftest/geometry_cases.cpp. trace_closest and
// trace_any are those of trace_rays.cl.
#include "trace_rays.cl"
#include "lights.h"

// Each ray against a leaf of its own.
kernel void hit_leaves(const global BvhLeaf* leaves, const global Ray* rays, global RayHit* hits, uint count) {
    const size_t i = get_global_id(0);
    if (i >= count)
        return;
    const Ray ray = rays[i];
    const BvhRay prepared = bvh_prepare_ray((float3)(ray.origin_x, ray.origin_y, ray.origin_z),
                                            (float3)(ray.direction_x, ray.direction_y, ray.direction_z));
    Hit hit = {ray.t_max, -1, 0.0f, 0.0f};
    bvh_closest_in_leaf(leaves + i, &prepared, &hit);
    hits[i].t = hit.t;
    hits[i].triangle = hit.triangle;
    hits[i].u = hit.u;
    hits[i].v = hit.v;
}

Interaction interaction_at(const global Triangle* triangles, const global RayHit* hits, size_t i) {
    Scene scene;
    scene.triangles = triangles;
    const Hit hit = {hits[i].t, max(hits[i].triangle, 0), hits[i].u, hits[i].v};
    return make_interaction(&scene, &hit);
}

Ray make_ray(float3 origin, float3 direction, float t_max) {
    const Ray ray = {origin.x, origin.y, origin.z, t_max, direction.x, direction.y, direction.z, 0.0f};
    return ray;
}

// Rays that leave the surfaces that were hit, in the given directions.
kernel void leave_surfaces(const global Triangle* triangles, const global RayHit* hits, const global float4* directions,
                           global Ray* leaving, uint count) {
    const size_t i = get_global_id(0);
    if (i >= count)
        return;
    const Interaction it = interaction_at(triangles, hits, i);
    const float3 direction = directions[i].xyz;
    leaving[i] = make_ray(leave_surface(&it, direction), direction, INFINITE_DISTANCE);
}

// Shadow rays to an area light from the surfaces that were hit.
kernel void shadow_rays(const global Triangle* triangles, const global RayHit* hits, const global SceneLight* light,
                        const global float4* u, global Ray* shadows, uint count) {
    const size_t i = get_global_id(0);
    if (i >= count)
        return;
    const Interaction it = interaction_at(triangles, hits, i);
    const DirectLight d = sample_direct(light, &it, it.normal, true, u[i].xy);
    shadows[i] = make_ray(d.origin, d.direction, d.t_max);
}

// Photons that leave an area light.
kernel void emitted_rays(const global SceneLight* light, const global float4* u, global Ray* emitted, uint count) {
    const size_t i = get_global_id(0);
    if (i >= count)
        return;
    Scene scene;
    const Emission e = sample_emission(&scene, light, u[i].xy, u[i].zw);
    emitted[i] = make_ray(e.origin, e.direction, INFINITE_DISTANCE);
}
