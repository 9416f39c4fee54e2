// Light sources: emission of photons and sampling of direct light. Spectra are kept apart: every quantity here is the
// factor of the light's spectrum.
#ifndef TRISTIM_LIGHTS_H
#define TRISTIM_LIGHTS_H

#include "scene.h"

// A light's kind.
int light_kind(const global SceneLight* light) {
#if LIGHT_KINDS == 1
    return HAS_POINT_LIGHT      ? LIGHT_POINT
           : HAS_SPOT_LIGHT     ? LIGHT_SPOT
           : HAS_DISTANT_LIGHT  ? LIGHT_DISTANT
           : HAS_INFINITE_LIGHT ? LIGHT_INFINITE
                                : LIGHT_AREA;
#else
    return light->kind;
#endif
}

// The light whose interval of the CDF holds u in [0, 1).
int choose_light(const Scene* scene, float u) {
    int low = 0, high = scene->constants->light_count;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (scene->light_cdf[middle] <= u)
            low = middle;
        else
            high = middle;
    }
    return low;
}

float3 light_position(const global SceneLight* light) {
    return (float3)(light->position_x, light->position_y, light->position_z);
}
float3 light_direction(const global SceneLight* light) {
    return (float3)(light->direction_x, light->direction_y, light->direction_z);
}
float3 area_light_point(const global SceneLight* light, float2 u) {
    const float2 b = sample_triangle(u);
    return light_position(light) + b.x * (float3)(light->edge1_x, light->edge1_y, light->edge1_z) +
           b.y * (float3)(light->edge2_x, light->edge2_y, light->edge2_z);
}

// A photon that leaves a light.
typedef struct Emission {
    float3 origin;
    float3 direction;
    float power;  // of the light, over the probability of choosing it: factor of its spectrum
} Emission;

// A ray that enters the scene's bounding sphere along a direction, through a point of the disc across it.
float3 enter_scene(const Scene* scene, float3 direction, float2 u) {
    const global SceneConstants* c = scene->constants;
    const Frame frame = make_frame(direction);
    const float2 d = c->radius * sample_disc(u);
    return (float3)(c->centre_x, c->centre_y, c->centre_z) + d.x * frame.s + d.y * frame.t - c->radius * direction;
}

// Every light emits photons in proportion to its emitted radiance, so all of its photons carry the same power.
Emission sample_emission(const Scene* scene, const global SceneLight* light, float2 u_direction, float2 u_position) {
    Emission e;
    e.origin = light_position(light);
    e.direction = light_direction(light);
    e.power = light->scale / light->probability;
    switch (light_kind(light)) {
#if HAS_POINT_LIGHT
    case LIGHT_POINT:
        e.direction = sample_sphere(u_direction);
        e.power *= 4.0f * PI;
        break;
#endif
#if HAS_SPOT_LIGHT
    case LIGHT_SPOT: {
        const Frame frame = make_frame(e.direction);
        const float cosine = sample_spot_cosine(u_direction.x, light->cos_total_width, light->cos_falloff_start);
        e.direction = frame_to_world(&frame, direction_at_cosine(cosine, u_direction.y));
        e.power *= spot_solid_angle(light->cos_total_width, light->cos_falloff_start);
        break;
    }
#endif
#if HAS_DISTANT_LIGHT
    case LIGHT_DISTANT:
        e.origin = enter_scene(scene, e.direction, u_position);
        e.power *= PI * scene->constants->radius * scene->constants->radius;
        break;
#endif
#if HAS_INFINITE_LIGHT
    case LIGHT_INFINITE:
        e.direction = sample_sphere(u_direction);
        e.origin = enter_scene(scene, e.direction, u_position);
        e.power *= 4.0f * PI * PI * scene->constants->radius * scene->constants->radius;
        break;
#endif
#if HAS_AREA_LIGHT
    case LIGHT_AREA: {
        float3 n = e.direction;
        e.power *= PI * light->area;
        if (light->two_sided) {
            e.power *= 2.0f;
            n = u_direction.x < 0.5f ? n : -n;
            u_direction.x = fmod(2.0f * u_direction.x, 1.0f);
        }
        const Frame frame = make_frame(n);
        e.direction = frame_to_world(&frame, sample_cosine_hemisphere(u_direction));
        e.origin = offset_from_triangle(area_light_point(light, u_position), n, light->extent);
        break;
    }
#endif
    }
    return e;
}

// Light that may reach a point straight from a light source.
typedef struct DirectLight {
    float3 origin;      // of the shadow ray
    float3 direction;   // not normalised: the light is at distance t_max = 1 along it, unless it is at infinity
    float irradiance;   // at the point with normal n, over the pdf: factor of the light's spectrum; 0 if none
    float t_max;
    int spectrum;
#if HAS_NEARLY_SPECULAR
    float pdf;          // [1/sr] of the direction, that of choosing the light included; 0: no ray can meet it by chance
#endif
} DirectLight;

#if HAS_NEARLY_SPECULAR
// DirectLight::pdf for a ray that met an area light at a distance, |cosine| of the angle there.
float area_light_pdf(const global SceneLight* light, float distance2, float cosine) {
    return light->probability * distance2 / (light->area * cosine);
}
// And for one that met none, where the surface that it left faces it at a cosine.
float infinite_light_pdf(const global SceneLight* light, float cosine, bool both_sides) {
    return light->probability * INV_PI * cosine * (both_sides ? 0.5f : 1.0f);
}
#endif

// Samples light from one source, chosen by choose_light; n is the shading normal on the side to light, unless light from both
// sides counts.
DirectLight sample_direct(const global SceneLight* light, const Interaction* it, float3 n, bool both_sides, float2 u) {
    DirectLight d;
    d.spectrum = light->spectrum;
    d.irradiance = light->scale / light->probability;
#if HAS_NEARLY_SPECULAR
    d.pdf = 0.0f;
#endif
#if HAS_DISTANT_LIGHT
    if (light_kind(light) == LIGHT_DISTANT) {
        d.direction = -light_direction(light);
        d.origin = leave_surface(it, d.direction);
        d.t_max = INFINITE_DISTANCE;
        d.irradiance *= max(both_sides ? fabs(dot(d.direction, n)) : dot(d.direction, n), 0.0f);
        return d;
    }
#endif
#if HAS_INFINITE_LIGHT
    if (light_kind(light) == LIGHT_INFINITE) {
        if (both_sides) {
            d.irradiance *= 2.0f;
            n = u.x < 0.5f ? n : -n;
            u.x = fmod(2.0f * u.x, 1.0f);
        }
        const Frame frame = make_frame(n);
        const float3 sampled = sample_cosine_hemisphere(u);
        d.direction = frame_to_world(&frame, sampled);
        d.origin = leave_surface(it, d.direction);
        d.t_max = INFINITE_DISTANCE;
        d.irradiance *= PI;  // cos θ / (cos θ / π)
#if HAS_NEARLY_SPECULAR
        d.pdf = infinite_light_pdf(light, sampled.z, both_sides);
#endif
        return d;
    }
#endif
    float3 target = light_position(light);
#if HAS_AREA_LIGHT
    if (light_kind(light) == LIGHT_AREA)
        target = area_light_point(light, u);
#endif
    const float3 towards = target - it->point;
    const float inverse_distance = 1.0f / sqrt(dot(towards, towards));
    const float cos_light = -dot(towards, light_direction(light)) * inverse_distance;
    const float facing = both_sides ? fabs(dot(towards, n)) : dot(towards, n);
    d.irradiance *= max(facing, 0.0f) * inverse_distance * inverse_distance * inverse_distance;
#if HAS_SPOT_LIGHT
    if (light_kind(light) == LIGHT_SPOT)
        d.irradiance *= spot_falloff(cos_light, light->cos_total_width, light->cos_falloff_start);
#endif
#if HAS_AREA_LIGHT
    if (light_kind(light) == LIGHT_AREA) {
        d.irradiance *= light->area * (light->two_sided ? fabs(cos_light) : max(cos_light, 0.0f));
#if HAS_NEARLY_SPECULAR
        d.pdf = area_light_pdf(light, dot(towards, towards), fabs(cos_light));
#endif
        // Seen from far away, the light is no more certain to lie where it is than the distance rounds.
        target = offset_from_triangle(target, cos_light >= 0.0f ? light_direction(light) : -light_direction(light),
                                      max(light->extent, 1.0f / inverse_distance));
    }
#endif
    d.origin = leave_surface(it, towards);
    d.direction = target - d.origin;
    d.t_max = 1.0f;
    return d;
}

#endif
