// Light that reaches a vertex of a camera path straight from a light source: next-event estimation.
#ifndef TRISTIM_DIRECT_LIGHT_H
#define TRISTIM_DIRECT_LIGHT_H

#include "bsdf.h"
#include "lights.h"

// XYZ of throughput · spectrum[first] · spectrum[second], the second one left out if negative.
float3 weighted_xyz(const Scene* scene, const PathWeight* weight, int first, int second) {
    const global float* a = spectrum_row(scene->pass_table, first);
    const global float* b = spectrum_row(scene->pass_table, max(second, 0));
    if (is_single(weight->slot)) {
        const float value = a[weight->slot] * (second >= 0 ? b[weight->slot] : 1.0f);
        return weight->scale * value * slot_weight(scene->pass_table, weight->slot);
    }
    Spectrum product;
    for (int i = 0; i < BLOCKS; ++i) {
        product.block[i] = vloadv(i, a);
        if (second >= 0)
            product.block[i] *= vloadv(i, b);
#if PATH_SPECTRUM
        product.block[i] *= weight->spectrum.block[i];
#endif
    }
    return weight->scale * spectrum_to_xyz(scene->pass_table, &product);
}

// At a diffuse surface with normal n on the side of the camera path. With a film, weight includes its transmittance towards the
// camera.
float3 diffuse_direct_light(const Scene* scene, const global SurfaceMaterial* material, const Interaction* it, float3 n,
                            const PathWeight* weight, float u_light, float2 u_point) {
    const int chosen = choose_light(scene, u_light);
    const DirectLight light = sample_direct(scene->lights + chosen, it, n, false, u_point);
    // Not !(> 0): a NaN goes on to the eye pass, which counts it.
    if (light.irradiance <= 0.0f || is_occluded(scene, light.origin, light.direction, light.t_max))
        return 0.0f;
#if HAS_COATED_DIFFUSE
    if (material->film_layers > 0) {
        const float cosine = min(dot(unit_vector(light.direction), n), 1.0f);
        const float thickness = film_thickness(scene, material, it);
        const Spectrum coat = coat_transmittance(scene, material, thickness, cosine, weight->slot);
        const Spectrum body = body_reflectance(scene, material, thickness, weight->slot);
        PathWeight lit = *weight;
        multiply_weight(&lit, &coat, INV_PI * light.irradiance);
        multiply_weight(&lit, &body, 1.0f);
        return weighted_xyz(scene, &lit, light.spectrum, -1);
    }
#endif
    return INV_PI * light.irradiance * weighted_xyz(scene, weight, light.spectrum, material->reflectance);
}

#if HAS_ROUGH
// At a rough surface. wo points along the camera path in `frame`, whose n is on that side, which is or is not the `outside`. Where
// the path goes on by scattering, the two ways to meet a light share it by the balance heuristic (Veach 1997, section 9.2).
float3 rough_direct_light(const Scene* scene, const global SurfaceMaterial* material, const Interaction* it, const Frame* frame,
                          float3 wo, bool outside, const PathWeight* weight, float u_light, float2 u_point) {
    const int chosen = choose_light(scene, u_light);
    const bool both_sides = is_dielectric(material);
    const DirectLight light = sample_direct(scene->lights + chosen, it, frame->n, both_sides, u_point);
    if (light.irradiance <= 0.0f)
        return 0.0f;
    const float3 towards = unit_vector(light.direction);
    const float3 wi = frame_from_world(frame, towards);
    // As for scattering: no light where the surface and its shading normal disagree on the side.
    if ((dot(towards, it->normal) >= 0.0f) != (outside == (wi.z > 0.0f)))
        return 0.0f;
    const float thickness = film_thickness(scene, material, it);
    const RoughScattering rough = evaluate_rough(scene, material, thickness, outside, wo, wi, weight->slot);
    if (rough.geometry <= 0.0f || is_occluded(scene, light.origin, light.direction, light.t_max))
        return 0.0f;
    const bool reflected = wi.z > 0.0f;
    float factor = light.irradiance * rough.geometry;
    if (!reflected) {
        const float inverse_eta = inverse_relative_eta(scene, material, outside, weight->slot);
        factor *= inverse_eta * inverse_eta;  // radiance
    }
#if HAS_NEARLY_SPECULAR
    if (is_nearly_specular(material) && light.pdf > 0.0f) {
        const float probability = reflection_probability(weight, &rough.optics);
        const float pdf = rough.pdf * (reflected ? probability : 1.0f - probability);
        factor *= light.pdf / (light.pdf + pdf);
    }
#endif
    PathWeight lit = *weight;
    multiply_weight(&lit, reflected ? &rough.optics.reflected : &rough.optics.transmitted, factor);
    return weighted_xyz(scene, &lit, light.spectrum, -1);
}
#endif

#endif
