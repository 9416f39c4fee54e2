// The scene's buffers as one argument list, and what a ray finds where it hits.
#ifndef TRISTIM_SCENE_H
#define TRISTIM_SCENE_H

#include "bvh.h"
#include "config.h"
#include "rng.h"
#include "sampling.h"
#include "shared_types.h"
#include "spectrum.h"
#include "texture.h"

// Rays traced, by kind of query.
typedef struct RayCounts {
    uint closest, any;
} RayCounts;

typedef struct Scene {
    const global SceneConstants* constants;
    const global BvhNode* nodes;
    const global BvhLeaf* leaves;
    const global Triangle* triangles;
    const global float* attributes;
    const global SurfaceMaterial* materials;
    const global SceneFilmLayer* film_layers;
    const global SceneTexture* textures;
    const global float* texels;
    const global SceneLight* lights;
    const global float* light_cdf;  // light_count + 1 values, from 0 to 1
    const global float* pass_table;
    const global uint* sobol_table;
    global Ray* recorded_rays;      // see record_ray
    global uint* recorded_count;
    RayCounts* counts;              // of this work-item
} Scene;

// Kernels that trace rays begin their parameter list with SCENE_PARAMETERS, in the order of host/render/scene_buffers.h,
// and their body with SCENE_FROM_PARAMETERS.
#define SCENE_PARAMETERS                                                                                               \
    const global SceneConstants *constants, const global BvhNode *nodes, const global BvhLeaf *leaves,                 \
        const global Triangle *triangles, const global float *attributes, const global SurfaceMaterial *materials,     \
        const global SceneFilmLayer *film_layers, const global SceneTexture *textures, const global float *texels,     \
        const global SceneLight *lights, const global float *light_cdf, const global float *pass_table,                \
        const global uint *sobol_table, global Ray *recorded_rays, global uint *recorded_count
#define SCENE_FROM_PARAMETERS                                                                                          \
    RayCounts ray_counts = {0, 0};                                                                                     \
    const Scene scene = {constants, nodes,     leaves,     triangles,   attributes,    materials,      film_layers,    \
                         textures,  texels,    lights,     light_cdf,   pass_table,    sobol_table,    recorded_rays,  \
                         recorded_count, &ray_counts}

#define INFINITE_DISTANCE 1e30f

// With RECORD_RAYS writes the ray to recorded_rays, shadow rays marked by Ray::unused = 1. recorded_count[0] is how many were
// traced, [1] how many fit.
void record_ray(const Scene* scene, float3 origin, float3 direction, float t_max, int any) {
#if RECORD_RAYS
    const uint index = atomic_inc(scene->recorded_count);
    if (index < scene->recorded_count[1]) {
        const Ray ray = {origin.x, origin.y, origin.z, t_max, direction.x, direction.y, direction.z, (float)any};
        scene->recorded_rays[index] = ray;
    }
#endif
}

Hit closest_hit(const Scene* scene, float3 origin, float3 direction) {
    ++scene->counts->closest;
    record_ray(scene, origin, direction, INFINITE_DISTANCE, 0);
    return bvh_closest_hit(scene->nodes, scene->leaves, origin, direction, INFINITE_DISTANCE);
}

bool is_occluded(const Scene* scene, float3 origin, float3 direction, float t_max) {
    ++scene->counts->any;
    record_ray(scene, origin, direction, t_max, 1);
    return bvh_any_hit(scene->nodes, scene->leaves, origin, direction, t_max);
}

// A point of a surface.
typedef struct Interaction {
    float3 point;
    float3 normal;          // unit geometric normal as the triangle stores it: out of solids, along area lights' emission
    float3 shading_normal;  // unit, on the same side
    float extent;           // of its triangle
    int material;
    int light;
#if HAS_UV
    float2 uv;
#endif
#if HAS_ANISOTROPIC
    float3 tangent;  // along ∂p/∂u, not normalised and not quite across the shading normal; 0 where u says nothing
#endif
} Interaction;

// What a triangle has at its vertices: normals, then u and v.
#define ATTRIBUTE_NORMALS 0
#define ATTRIBUTE_UV (9 * HAS_SHADING_NORMALS)


Interaction make_interaction(const Scene* scene, const Hit* hit) {
    const global Triangle* triangle = scene->triangles + hit->triangle;
    Interaction it;
    it.point = (float3)(triangle->v0_x, triangle->v0_y, triangle->v0_z) +
               hit->u * (float3)(triangle->edge1_x, triangle->edge1_y, triangle->edge1_z) +
               hit->v * (float3)(triangle->edge2_x, triangle->edge2_y, triangle->edge2_z);
    it.normal = (float3)(triangle->normal_x, triangle->normal_y, triangle->normal_z);
    it.extent = triangle->extent;
    it.material = triangle->material;
    it.light = triangle->light;
    it.shading_normal = it.normal;
#if HAS_SHADING_NORMALS
    if (triangle->attributes >= 0) {
        const global float* n = scene->attributes + triangle->attributes + ATTRIBUTE_NORMALS;
        const float3 blended = (1.0f - hit->u - hit->v) * vload3(0, n) + hit->u * vload3(1, n) + hit->v * vload3(2, n);
        const float squared = dot(blended, blended);
        if (squared > 0.0f)
            it.shading_normal = blended * rsqrt(squared);
    }
#endif
#if HAS_UV
    const global float* uv = scene->attributes + triangle->attributes + ATTRIBUTE_UV;
    const float2 uv0 = vload2(0, uv), uv1 = vload2(1, uv), uv2 = vload2(2, uv);
    it.uv = (1.0f - hit->u - hit->v) * uv0 + hit->u * uv1 + hit->v * uv2;
#endif
#if HAS_ANISOTROPIC
    // ∂p/∂u but for the determinant's size: edge = u' ∂p/∂u + v' ∂p/∂v for both edges.
    const float2 along1 = uv1 - uv0, along2 = uv2 - uv0;
    const float3 edge1 = (float3)(triangle->edge1_x, triangle->edge1_y, triangle->edge1_z);
    const float3 edge2 = (float3)(triangle->edge2_x, triangle->edge2_y, triangle->edge2_z);
    it.tangent = copysign(1.0f, along1.x * along2.y - along2.x * along1.y) * (along2.y * edge1 - along1.y * edge2);
#endif
    return it;
}

// Where a ray leaves a surface in a direction.
float3 leave_surface(const Interaction* it, float3 direction) {
    return offset_from_triangle(it->point, dot(direction, it->normal) >= 0.0f ? it->normal : -it->normal, it->extent);
}

// The normal to shade with, on one side of a surface, and whether that is the outside.
typedef struct Facing {
    float3 normal;
    bool outside;
} Facing;

// The side that the unit vector `towards` points to; *cosine becomes that between the two, in [0, 1]. A shading normal that
// would put `towards` on the other side than the surface really has gives way to the geometric one.
Facing facing_normal(const Interaction* it, float3 towards, float* cosine) {
    const float geometric = dot(towards, it->normal);
    float3 n = it->normal;
    float c = geometric;
#if HAS_SHADING_NORMALS
    const float shading = dot(towards, it->shading_normal);
    if (geometric * shading > 0.0f) {
        n = it->shading_normal;
        c = shading;
    }
#endif
    Facing facing;
    facing.outside = geometric >= 0.0f;
    facing.normal = facing.outside ? n : -n;
    *cosine = min(fabs(c), 1.0f);
    return facing;
}

#endif
