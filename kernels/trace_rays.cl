// Traces a buffer of rays: for tests and for measuring the traversal alone.
#include "bvh.h"

kernel void trace_closest(const global BvhNode* nodes, const global BvhLeaf* leaves, const global Ray* rays,
                          global RayHit* hits, uint count) {
    const size_t i = get_global_id(0);
    if (i >= count)
        return;
    const Ray ray = rays[i];
    const Hit hit = bvh_closest_hit(nodes, leaves, (float3)(ray.origin_x, ray.origin_y, ray.origin_z),
                                    (float3)(ray.direction_x, ray.direction_y, ray.direction_z), ray.t_max);
    hits[i].t = hit.t;
    hits[i].triangle = hit.triangle;
    hits[i].u = hit.u;
    hits[i].v = hit.v;
}

kernel void trace_any(const global BvhNode* nodes, const global BvhLeaf* leaves, const global Ray* rays,
                      global int* occluded, uint count) {
    const size_t i = get_global_id(0);
    if (i >= count)
        return;
    const Ray ray = rays[i];
    occluded[i] = bvh_any_hit(nodes, leaves, (float3)(ray.origin_x, ray.origin_y, ray.origin_z),
                              (float3)(ray.direction_x, ray.direction_y, ray.direction_z), ray.t_max)
                      ? 1
                      : 0;
}
