// Reflection and refraction at smooth interfaces.
#ifndef TRISTIM_OPTICS_H
#define TRISTIM_OPTICS_H

#include "spectrum.h"

// cos² θ_t by Snell's law; 0 or less at total reflection. cos_i >= 0 is the cosine on the incident side, inverse_eta the index
// of this side over that of the other. As cos² θ_i + (1 - 1/η²) sin² θ_i it has no term beyond cos² θ_i in size near a critical
// angle; 1 - sin² θ_i/η² would leave grazing light no digits where the indices match.
float refracted_cosine_squared(float cos_i, float inverse_eta) {
    const float sin2_i = (1.0f - cos_i) * (1.0f + cos_i);
    return cos_i * cos_i + (1.0f - inverse_eta) * (1.0f + inverse_eta) * sin2_i;
}

// Fresnel reflectance of a dielectric for unpolarised light (Born & Wolf 1999, section 1.5.2); arguments as above. *cos_t
// becomes the cosine beyond, 0 at total reflection. With c = cos θ_i, c' = cos θ_t and b = c/η + c' the amplitudes are, but for
// their signs,
//     s = (1 - 1/η²)/b²,    p/s = cos(θ_i + θ_t)/cos(θ_i - θ_t) = (cc' - sin² θ_i/η)/(cc' + sin² θ_i/η):
// no differences that cancel where η is nearly 1.
float fresnel_dielectric(float cos_i, float inverse_eta, float* cos_t) {
    const float cos2_t = refracted_cosine_squared(cos_i, inverse_eta);
    *cos_t = sqrt(max(cos2_t, 0.0f));
    const float b = inverse_eta * cos_i + *cos_t;
    const float cosines = cos_i * *cos_t, sines = inverse_eta * (1.0f - cos_i) * (1.0f + cos_i);
    const float sum = cosines + sines, difference = cosines - sines;
    const float ratio = (1.0f - inverse_eta) * (1.0f + inverse_eta) / (b * b * sum);
    const float reflectance = 0.5f * ratio * ratio * (sum * sum + difference * difference);
    return cos2_t <= 0.0f ? 1.0f : reflectance;
}

// Fresnel reflectance of a conductor with index eta + ik for unpolarised light arriving from vacuum (Born & Wolf 1999,
// section 14.4.1), for a vector of wavelengths or one. `difference` is the real part of q² = (eta + ik)² - sin² θ. The smaller
// part of q comes from the larger one, without cancellation: in a good mirror it is what absorbs.
#define DEFINE_FRESNEL_CONDUCTOR(name, type)                                                                           \
    type name(float cos_i, type eta, type k) {                                                                         \
        const float cos2 = cos_i * cos_i;                                                                              \
        const float sin2 = (1.0f - cos_i) * (1.0f + cos_i);                                                            \
        const type difference = eta * eta * cos2 + (eta - 1.0f) * (eta + 1.0f) * sin2 - k * k;                         \
        const type magnitude = max(fabs(difference), (type)(FLT_MIN));                                                 \
        const type modulus = max(sqrt(difference * difference + 4.0f * eta * eta * k * k), magnitude);                 \
        const type larger = sqrt(0.5f * (modulus + magnitude));                                                        \
        const type a = difference >= 0.0f ? larger : eta * k / larger;                                                 \
        const type two_a_cos = 2.0f * cos_i * a;                                                                       \
        const type s = (modulus + cos2 - two_a_cos) / (modulus + cos2 + two_a_cos);                                    \
        const type with_cos = cos2 * modulus + sin2 * sin2;                                                            \
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
