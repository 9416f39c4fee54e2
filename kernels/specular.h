// Smooth dielectrics and conductors without a film, and what others share with them.
#ifndef TRISTIM_SPECULAR_H
#define TRISTIM_SPECULAR_H

#include "optics.h"
#include "path_weight.h"
#include "scene.h"

// Of the kinds that the scene has, a material's; is_dielectric is for surfaces that are not diffuse.
bool is_diffuse(const global SurfaceMaterial* material) { return !HAS_SPECULAR || material->kind == MATERIAL_DIFFUSE; }
bool is_dielectric(const global SurfaceMaterial* material) {
    return HAS_CONDUCTOR ? HAS_DIELECTRIC && material->kind == MATERIAL_DIELECTRIC : HAS_DIELECTRIC;
}
bool is_conductor(const global SurfaceMaterial* material) { return HAS_CONDUCTOR && material->kind == MATERIAL_CONDUCTOR; }
bool is_rough(const global SurfaceMaterial* material) { return HAS_ROUGH && material->alpha_u > 0.0f; }
int film_layers_on(const global SurfaceMaterial* material) { return HAS_FILM ? material->film_layers : 0; }

// Index of the side that light comes from over that of the other, for a dielectric.
float inverse_relative_eta(const Scene* scene, const global SurfaceMaterial* material, bool outside, int slot) {
    const float eta = spectrum_row(scene->pass_table, material->eta)[is_single(slot) ? slot : 0];
    return outside ? 1.0f / eta : eta;
}

#if HAS_DIELECTRIC
// Reflects or refracts about a normal on the incident side; u in [0, 1) decides.
float3 reflect_or_refract(float3 direction, float3 n, float cos_i, float inverse_eta, float u, bool* refracted) {
    float cos_t;
    *refracted = u >= fresnel_dielectric(cos_i, inverse_eta, &cos_t);
    // Both are cheaper than a branch that no processor can foresee.
    const float3 reflection = reflect(direction, n, cos_i);
    const float3 refraction = refract(direction, n, inverse_eta, cos_i, cos_t);
    return *refracted ? refraction : reflection;
}

// Reflects or refracts at a smooth dielectric, by chance in proportion to the Fresnel reflectance, so that neither changes
// the weight. `radiance` says that the path runs from the camera: radiance scales by (η_i/η_t)² at refraction, flux does not
// (Veach 1997, section 5.2). Returns the new direction.
float3 scatter_dielectric(const Scene* scene, const global SurfaceMaterial* material, const Interaction* it,
                          float3 direction, float u, bool radiance, PathWeight* weight) {
    float cos_i;
    const Facing facing = facing_normal(it, -direction, &cos_i);
    const float inverse_eta = inverse_relative_eta(scene, material, facing.outside, weight->slot);
    bool refracted;
    float3 scattered = reflect_or_refract(direction, facing.normal, cos_i, inverse_eta, u, &refracted);
#if HAS_SHADING_NORMALS
    // At grazing angles a shading normal may send the ray to the wrong side, where it would count as inside what it never
    // entered: then the geometric normal takes its place.
    if ((dot(scattered, it->normal) >= 0.0f) != (facing.outside != refracted)) {
        const float3 n = facing.outside ? it->normal : -it->normal;
        scattered = reflect_or_refract(direction, n, min(-dot(direction, n), 1.0f), inverse_eta, u, &refracted);
    }
#endif
    if (radiance)
        weight->scale *= refracted ? inverse_eta * inverse_eta : 1.0f;
    return scattered;
}
#endif

// Mirrors a direction at a smooth surface, which it meets at `cosine`. A shading normal that would send it through the surface gives
// way to the geometric one.
float3 mirror(const Interaction* it, Facing facing, float cosine, float3 direction) {
    const float3 mirrored = reflect(direction, facing.normal, cosine);
#if HAS_SHADING_NORMALS
    if ((dot(mirrored, it->normal) >= 0.0f) != facing.outside)
        return reflect(direction, it->normal, -dot(direction, it->normal));
#endif
    return mirrored;
}

#if HAS_CONDUCTOR
// Reflects at a smooth conductor; the Fresnel reflectance multiplies the weight. Returns the new direction.
float3 scatter_conductor(const Scene* scene, const global SurfaceMaterial* material, const Interaction* it,
                         float3 direction, PathWeight* weight) {
    float cos_i;
    const Facing facing = facing_normal(it, -direction, &cos_i);
    const global float* eta = spectrum_row(scene->pass_table, material->eta);
    const global float* k = spectrum_row(scene->pass_table, material->k);
    if (is_single(weight->slot)) {
        weight->scale *= fresnel_conductor(cos_i, eta[weight->slot], k[weight->slot]);
    } else {
        for (int b = 0; b < BLOCKS; ++b)
            weight->spectrum.block[b] *= fresnel_conductor_lanes(cos_i, vloadv(b, eta), vloadv(b, k));
    }
    return mirror(it, facing, cos_i, direction);
}
#endif

#endif
