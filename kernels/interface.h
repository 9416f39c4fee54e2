// Interfaces with a thin film, rough ones, and both: light is reflected and transmitted at the interface, or at each facet of a
// rough one, by shares that depend on the wavelength.
#ifndef TRISTIM_INTERFACE_H
#define TRISTIM_INTERFACE_H

#include "microfacet.h"
#include "specular.h"
#include "thin_film.h"

// Thickness in nm of the outermost layer of the film where it is met; 0 without a film.
float film_thickness(const Scene* scene, const global SurfaceMaterial* material, const Interaction* it) {
#if HAS_TEXTURE
    if (material->film_texture >= 0) {
#if HAS_UV
        const float2 uv = it->uv;
#else
        const float2 uv = 0.0f;
#endif
        return fmax(evaluate_texture(scene->textures + material->film_texture, scene->texels, it->point, uv), 0.0f);
    }
#endif
    return film_layers_on(material) > 0 ? scene->film_layers[material->film].thickness : 0.0f;
}

// Shares of the power of unpolarised light that are reflected and transmitted; what is neither is absorbed.
typedef struct InterfaceOptics {
    Spectrum reflected, transmitted;
} InterfaceOptics;

// For light that comes from outside, or from inside a dielectric, at an angle of cosine cos_i; a conductor, which has no inside, is
// the same from both sides. Of the blocks of wavelengths only that of `slot` is set, unless slot is SLOT_ALL. thickness is that of
// the film's first layer.
InterfaceOptics interface_optics(const Scene* scene, const global SurfaceMaterial* material, float thickness, bool outside,
                                 float cos_i, int slot) {
    const ThinFilm film = {scene->film_layers + material->film, film_layers_on(material), thickness};
    const global float* eta = spectrum_row(scene->pass_table, material->eta);
    const global float* k = spectrum_row(scene->pass_table, material->k);
    const bool opaque = is_conductor(material);
    const int first = first_block(slot), last = last_block(slot);
    InterfaceOptics optics;
    for (int b = first; b < last; ++b) {
        const FilmOptics o = film_optics(scene->pass_table, b, &film, outside || opaque, cos_i, (floatv)(1.0f), vloadv(b, eta),
                                         opaque ? vloadv(b, k) : (floatv)(0.0f));
        optics.reflected.block[b] = 0.5f * (o.reflected_s + o.reflected_p);
        optics.transmitted.block[b] = opaque ? (floatv)(0.0f) : 0.5f * (o.transmitted_s + o.transmitted_p);
    }
    return optics;
}

// The frame in which the surface's roughness is given, around n: any frame if it is the same in all directions.
Frame surface_frame(const global SurfaceMaterial* material, const Interaction* it, float3 n) {
#if HAS_ANISOTROPIC
    if (material->alpha_u == material->alpha_v)
        return make_frame(n);
    const float3 across = it->tangent - dot(it->tangent, n) * n;
    const float length2 = dot(across, across);
    if (length2 > 1e-10f * dot(it->tangent, it->tangent)) {
        Frame frame;
        frame.s = across * rsqrt(length2);
        frame.t = cross(n, frame.s);
        frame.n = n;
        return frame;
    }
#endif
    return make_frame(n);
}

#if HAS_ROUGH
// What a rough surface does with light between two directions: `reflectance` (for each wavelength, of its facets) times geometry is
// the BSDF that scatters flux.
typedef struct RoughScattering {
    InterfaceOptics optics;  // of the facets that do it
    float geometry;          // 0: no facet does
    float pdf;               // [1/sr] of wi, given wo and the choice between reflection and refraction
} RoughScattering;

// wo and wi in the surface's frame, wo.z > 0 on the side `outside`.
RoughScattering evaluate_rough(const Scene* scene, const global SurfaceMaterial* material, float thickness, bool outside,
                               float3 wo, float3 wi, int slot) {
    const float2 alpha = (float2)(material->alpha_u, material->alpha_v);
    RoughScattering result;
    result.geometry = 0.0f;
    float3 m = (float3)(0.0f, 0.0f, 1.0f);
    if (wi.z > 0.0f) {
        result.geometry = ggx_reflection(wo, wi, alpha, &m);
        result.pdf = ggx_reflection_pdf(wo, m, alpha);
    } else if (is_dielectric(material)) {
        const float eta = 1.0f / inverse_relative_eta(scene, material, outside, slot);
        result.geometry = ggx_refraction(wo, wi, eta, alpha, &m);
        result.pdf = ggx_refraction_pdf(wo, wi, m, eta, alpha);
    }
    if (result.geometry > 0.0f)
        result.optics = interface_optics(scene, material, thickness, outside, min(dot(wo, m), 1.0f), slot);
    return result;
}
#endif

// The probability with which a path of this weight is reflected; what is neither reflected nor transmitted lessens the weight.
float reflection_probability(const PathWeight* weight, const InterfaceOptics* optics) {
    const float reflected = carried_sum(weight, &optics->reflected);
    const float transmitted = carried_sum(weight, &optics->transmitted);
    return reflected > 0.0f ? reflected / (reflected + transmitted) : 0.0f;
}

// See scatter in bsdf.h. A rough surface's facet is drawn by u.yz among those that the path sees.
bool scatter_interface(const Scene* scene, const global SurfaceMaterial* material, const Interaction* it, float3* direction,
                       float3 u, bool radiance, PathWeight* weight, float* pdf) {
    float cosine;
    Facing facing = facing_normal(it, -*direction, &cosine);
    const float thickness = film_thickness(scene, material, it);
    const float inverse_eta = inverse_relative_eta(scene, material, facing.outside, weight->slot);
    const bool rough = is_rough(material);
    for (int attempt = 0; attempt < 2; ++attempt) {
        float3 m = facing.normal;
        float cos_i = cosine;
#if HAS_ROUGH
        float3 facet;  // m in the surface's frame
        const float2 alpha = (float2)(material->alpha_u, material->alpha_v);
        float3 wo;
        Frame frame;
        if (rough) {
            frame = surface_frame(material, it, facing.normal);
            wo = frame_from_world(&frame, -*direction);
            wo.z = cosine;
            facet = sample_ggx_visible_normal(wo, alpha, u.yz);
            cos_i = clamp(dot(wo, facet), 0.0f, 1.0f);
            m = frame_to_world(&frame, facet);
        }
#endif
        const InterfaceOptics optics =
            interface_optics(scene, material, thickness, facing.outside, cos_i, weight->slot);
        const float probability = reflection_probability(weight, &optics);
        const bool reflected = u.x < probability;
        float3 scattered;
        if (reflected) {
            scattered = reflect(*direction, m, cos_i);
        } else {
            const float cos2_t = refracted_cosine_squared(cos_i, inverse_eta);
            if (cos2_t <= 0.0f || !is_dielectric(material))
                return false;  // nothing is transmitted
            scattered = refract(*direction, m, inverse_eta, cos_i, sqrt(cos2_t));
        }
        const bool above = facing.outside == reflected;  // where it must go
        if ((dot(scattered, it->normal) >= 0.0f) != above) {
            if (rough)
                return false;  // would meet another facet: single scattering leaves it out
            // As in scatter_dielectric, the geometric normal takes the place of the shading one.
            facing.normal = facing.outside ? it->normal : -it->normal;
            cosine = min(fabs(dot(*direction, it->normal)), 1.0f);
            continue;
        }
#if HAS_ROUGH
        if (rough) {
            const float3 wi = frame_from_world(&frame, scattered);
            if ((wi.z > 0.0f) != reflected)
                return false;
            weight->scale *= ggx_visible_normal_weight(wo, wi, alpha);
            *pdf = reflected ? probability * ggx_reflection_pdf(wo, facet, alpha)
                             : (1.0f - probability) * ggx_refraction_pdf(wo, wi, facet, 1.0f / inverse_eta, alpha);
        }
#endif
        if (reflected)
            multiply_weight(weight, &optics.reflected, 1.0f / probability);
        else
            multiply_weight(weight, &optics.transmitted, 1.0f / (1.0f - probability));
        if (radiance && !reflected)
            weight->scale *= inverse_eta * inverse_eta;
        *direction = scattered;
        return true;
    }
    return false;
}

#endif
