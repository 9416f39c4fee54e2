// Reflection and refraction at smooth interfaces.
#ifndef TRISTIM_OPTICS_H
#define TRISTIM_OPTICS_H

#include "spectrum.h"

// Fresnel reflectance of a dielectric for unpolarised light (Born & Wolf 1999, section 1.5.2). cos_i >= 0 is the cosine on
// the incident side, inverse_eta the index of this side over that of the other. *cos_t becomes the cosine beyond, 0 at total
// reflection. sin²θ_i is formed as (1-c)(1+c), which keeps its digits at normal incidence.
float fresnel_dielectric(float cos_i, float inverse_eta, float* cos_t) {
    const float sin2_i = (1.0f - cos_i) * (1.0f + cos_i);
    const float cos2_t = 1.0f - sin2_i * inverse_eta * inverse_eta;
    *cos_t = sqrt(max(cos2_t, 0.0f));
    // s = a/b and p = c/d: (s² + p²)/2 by one division.
    const float a = inverse_eta * cos_i - *cos_t, b = inverse_eta * cos_i + *cos_t;
    const float c = cos_i - inverse_eta * *cos_t, d = cos_i + inverse_eta * *cos_t;
    const float ad = a * d, cb = c * b, bd = b * d;
    const float reflectance = 0.5f * (ad * ad + cb * cb) / (bd * bd);
    return cos2_t <= 0.0f ? 1.0f : reflectance;
}

// Fresnel reflectance of a conductor with index eta + ik for unpolarised light arriving from vacuum (Born & Wolf 1999,
// section 14.4.1), for a vector of wavelengths or one.
#define DEFINE_FRESNEL_CONDUCTOR(name, type)                                                                           \
    type name(float cos_i, type eta, type k) {                                                                         \
        const float cos2 = cos_i * cos_i;                                                                              \
        const float sin2 = (1.0f - cos_i) * (1.0f + cos_i);                                                            \
        const type difference = eta * eta - k * k - sin2;                                                              \
        const type a2_plus_b2 = sqrt(difference * difference + 4.0f * eta * eta * k * k);                              \
        const type a = sqrt(max(0.5f * (a2_plus_b2 + difference), (type)(0.0f)));                                      \
        const type two_a_cos = 2.0f * cos_i * a;                                                                       \
        const type s = (a2_plus_b2 + cos2 - two_a_cos) / (a2_plus_b2 + cos2 + two_a_cos);                              \
        const type with_cos = cos2 * a2_plus_b2 + sin2 * sin2;                                                         \
        const type with_sin = two_a_cos * sin2;                                                                        \
        return 0.5f * s * (1.0f + (with_cos - with_sin) / (with_cos + with_sin));                                      \
    }

DEFINE_FRESNEL_CONDUCTOR(fresnel_conductor, float)
DEFINE_FRESNEL_CONDUCTOR(fresnel_conductor_lanes, floatv)

// direction towards the surface; cos_i its cosine to -n.
float3 reflect(float3 direction, float3 n, float cos_i) { return direction + 2.0f * cos_i * n; }

// Snell's law in vector form; arguments as in fresnel_dielectric, without total reflection. The result's length is that of
// direction, 1, within rounding: cos_t was computed from the same sine.
float3 refract(float3 direction, float3 n, float inverse_eta, float cos_i, float cos_t) {
    return inverse_eta * direction + (inverse_eta * cos_i - cos_t) * n;
}

#endif
