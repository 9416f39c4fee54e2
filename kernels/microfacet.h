// The GGX microfacet distribution (Trowbridge & Reitz 1975; Walter et al. 2007, "Microfacet Models for Refraction
// through Rough Surfaces") with Smith's masking (Heitz 2014, "Understanding the Masking-Shadowing Function in
// Microfacet-Based BRDFs").
//
// Everything is in the local frame, z along the surface's normal; alpha = (α_u, α_v) > 0 is the roughness along x and
// y, two equal ones are the isotropic distribution. wo and wi are unit vectors that point away from the surface. wo is
// on the normal's side, wo.z >= 0 (who comes from below turns the frame round); wi.z > 0 is reflection, wi.z < 0
// transmission. Microfacet normals m are unit vectors with m.z >= 0. eta is the index on wi's side over that on wo's
// side, n_i/n_o, and not 1: between equal indices there is no interface.
//
// Masking is written with the length of the stretched vector, |(α_u x, α_v y, z)| = |z| √(1 + α² tan²θ): nothing then
// divides by a cosine, and no difference of nearly equal numbers is left. float keeps five digits from α = 1e-4 to 1,
// up to grazing angles.
#ifndef TRISTIM_MICROFACET_H
#define TRISTIM_MICROFACET_H

#include "multiply_add.h"
#include "sampling.h"

// Directions nearer to the horizon scatter nothing: squares of half vectors could underflow, and values overflow.
#define GGX_HORIZON 1e-18f

// D(m) [1/sr], with ∫ D(m) m.z dm = 1 (Walter et al. 2007, eq. 33; for two roughnesses Heitz 2014).
float ggx_distribution(float3 m, float2 alpha) {
    const float inverse_product = 1.0f / (alpha.x * alpha.y);
    const float2 slope = m.xy * alpha.yx * inverse_product;
    const float e = slope.x * slope.x + slope.y * slope.y + m.z * m.z;
    return INV_PI * inverse_product / (e * e);
}

// (α_u x)² + (α_v y)² of w.
float ggx_stretched_sine2(float3 w, float2 alpha) {
    const float2 stretched = w.xy * alpha;
    return stretched.x * stretched.x + stretched.y * stretched.y;
}

float ggx_stretched_length(float3 w, float2 alpha) { return sqrt(ggx_stretched_sine2(w, alpha) + w.z * w.z); }

// Smith's Λ(w) = (√(1 + α² tan²θ) - 1) / 2 (Heitz 2014, eq. 72); infinite at w.z = 0.
float ggx_lambda(float3 w, float2 alpha) {
    const float z = fabs(w.z), sine2 = ggx_stretched_sine2(w, alpha);
    return 0.5f * sine2 / (z * (z + sqrt(sine2 + z * z)));
}

// G1(w) = 1 / (1 + Λ(w)): the share of the facets that face w which w sees. The caller sees to it that they do.
float ggx_masking(float3 w, float2 alpha) {
    const float z = fabs(w.z);
    return 2.0f * z / (z + ggx_stretched_length(w, alpha));
}

// (1 + Λ(wo) + Λ(wi)) · 2 |wo.z| |wi.z|, at least the smallest normal number.
float ggx_correlated_sum(float3 wo, float3 wi, float2 alpha) {
    return max(fabs(wi.z) * ggx_stretched_length(wo, alpha) + fabs(wo.z) * ggx_stretched_length(wi, alpha), FLT_MIN);
}

// G2 = 1 / (1 + Λ(wo) + Λ(wi)), masking and shadowing correlated by height (Heitz 2014, eq. 99). Transmission takes the
// same, as in pbrt-v4.
float ggx_masking_shadowing(float3 wo, float3 wi, float2 alpha) {
    return 2.0f * fabs(wo.z) * fabs(wi.z) / ggx_correlated_sum(wo, wi, alpha);
}

// G2 / G1(wo), in [0, 1]: the weight, beside Fresnel's share, of a direction that was reflected or refracted at a
// sampled visible normal of wo. The caller drops directions that came out on the wrong side.
float ggx_visible_normal_weight(float3 wo, float3 wi, float2 alpha) {
    return fabs(wi.z) * (fabs(wo.z) + ggx_stretched_length(wo, alpha)) / ggx_correlated_sum(wo, wi, alpha);
}

// A facet's normal with the pdf below; u in [0, 1)². Stretching turns the surface into a hemisphere, whose visible
// normals are half vectors of wo and the directions of a spherical cap (Dupuy & Benyoub 2023, "Sampling Visible GGX
// Normals with Spherical Caps"). The cap's z is (1 - u.x)(1 + v.z) - v.z, which appears only in sums without
// cancellation. Next to -v, rounding, of 41 units at most, could turn the half vector away from wo; the cap's points
// come nearer to the axis by 64. So wo·m >= 0 but for the rounding of m and of the product, 2^-19: callers clamp it.
float3 sample_ggx_visible_normal(float3 wo, float2 alpha, float2 u) {
    const float3 v = unit_vector((float3)(wo.xy * alpha, wo.z));
    const float top = 1.0f + v.z, rest = 1.0f - u.x;
    const float sine = sqrt(u.x * (rest * top * top + v.x * v.x + v.y * v.y));
    const float2 half_xy = (1.0f - 0x1p-18f) * sine * cos_sin_turns(u.y) + v.xy;
    return unit_vector((float3)(half_xy * alpha, rest * top));
}

// G1(wo) max(0, wo·m) D(m) / wo.z [1/sr]: the density of the facets that wo sees (Heitz 2014).
float ggx_visible_normal_pdf(float3 wo, float3 m, float2 alpha) {
    return ggx_distribution(m, alpha) * 2.0f * max(0.0f, dot(wo, m)) / (fabs(wo.z) + ggx_stretched_length(wo, alpha));
}

// The facet that reflects wo to wi.
float3 reflection_half_vector(float3 wo, float3 wi) { return unit_vector(wo + wi); }

// The facet that refracts wo to wi, turned so that m.z >= 0 (Walter et al. 2007, eq. 16). It refracts only if
// wo·m > 0 > wi·m. fma rounds once, so that the components of a sum that nearly cancels are still right.
float3 refraction_half_vector(float3 wo, float3 wi, float eta) {
    const float3 sum = fused_multiply_add((float3)(eta), wi, wo);
    const float3 m = sum * (1.0f / sqrt(max(dot(sum, sum), FLT_MIN)));  // 0 if eta is 1 and wi = -wo
    return m.z < 0.0f ? -m : m;
}

// dm/dwi of refraction, |wi·m| (eta / (wo·m + eta wi·m))² (Walter et al. 2007, eq. 17), wo_m = wo·m > 0 > wi_m = wi·m. That of
// reflection is 1 / (4 wo·m). By Snell's law, which the three obey, the sum in it is (1 - eta²)/(wo·m - eta wi·m), where nothing
// cancels. For eta = 1 its next neighbour stands, so that the lobe, then a single direction, stays finite.
float refraction_jacobian(float wo_m, float wi_m, float eta) {
    const float difference = max(fabs((eta - 1.0f) * (eta + 1.0f)), FLT_EPSILON);
    const float ratio = eta * multiply_add(-eta, wi_m, wo_m) / difference;
    return fabs(wi_m) * ratio * ratio;
}

// The pdf [1/sr] over wi of reflecting wo at a visible normal, which was m: ggx_visible_normal_pdf / (4 wo·m).
float ggx_reflection_pdf(float3 wo, float3 m, float2 alpha) {
    return 0.5f * ggx_distribution(m, alpha) / (fabs(wo.z) + ggx_stretched_length(wo, alpha));
}

// The pdf [1/sr] over wi of refracting wo at a visible normal, which was m.
float ggx_refraction_pdf(float3 wo, float3 wi, float3 m, float eta, float2 alpha) {
    return ggx_visible_normal_pdf(wo, m, alpha) * refraction_jacobian(dot(wo, m), dot(wi, m), eta);
}

// The rough surface's BRDF [1/sr] but for the Fresnel reflectance at cosine wo·m: D G2 / (4 wo.z wi.z) (Walter et al.
// 2007, eq. 20). 0 if wo and wi are not both above; *m, the facet, is then not to be used.
float ggx_reflection(float3 wo, float3 wi, float2 alpha, float3* m) {
    if (!(wo.z > GGX_HORIZON && wi.z > GGX_HORIZON))
        return 0.0f;
    *m = reflection_half_vector(wo, wi);
    return 0.5f * ggx_distribution(*m, alpha) / ggx_correlated_sum(wo, wi, alpha);
}

// The rough surface's BTDF [1/sr] but for the Fresnel transmittance at cosine wo·m (Walter et al. 2007, eq. 21, times
// eta²): D G2 |wo·m| |wi·m| / (|wo.z| |wi.z| (wi·m + wo·m/eta)²). In this form it scatters flux, of a photon that came
// from wo and leaves along wi: ∫ f |wi.z| dwi <= 1. Radiance that a camera path from wo finds along wi has f/eta²
// (Veach 1997, section 5.2). So f(wo, wi, eta) = eta² f(wi, wo, 1/eta), the frame turned round. 0 if no facet refracts
// wo to wi; *m, the facet, is then not to be used.
float ggx_refraction(float3 wo, float3 wi, float eta, float2 alpha, float3* m) {
    if (!(wo.z > GGX_HORIZON && wi.z < -GGX_HORIZON))
        return 0.0f;
    *m = refraction_half_vector(wo, wi, eta);
    const float wo_m = dot(wo, *m), wi_m = dot(wi, *m);
    if (!(wo_m > 0.0f && wi_m < 0.0f))
        return 0.0f;
    return 2.0f * ggx_distribution(*m, alpha) * wo_m * refraction_jacobian(wo_m, wi_m, eta) /
           ggx_correlated_sum(wo, wi, alpha);
}

#endif
