// The numerical cores of reflection, refraction and the sampling of directions, a kernel for each, for `tristim selftest`
// (host/selftest/optics_cases.h). Every kernel reads and writes a fixed number of float4 for each work-item.
#include "microfacet.h"
#include "optics.h"

// (cos_i, 1/eta) to (reflectance, cos_t).
kernel void dielectric(const global float4* in, global float4* out) {
    const size_t i = get_global_id(0);
    float cos_t;
    const float reflectance = fresnel_dielectric(in[i].x, in[i].y, &cos_t);
    out[i] = (float4)(reflectance, cos_t, 0.0f, 0.0f);
}

// (cos_i, eta, k) to the reflectance by the scalar function and by a lane among others of the vector one.
kernel void conductor(const global float4* in, global float4* out) {
    const size_t i = get_global_id(0);
    const float scalar = fresnel_conductor(in[i].x, in[i].y, in[i].z);
    floatv eta = 0.2f, k = 3.0f;
    eta.s2 = in[i].y;
    k.s2 = in[i].z;
    out[i] = (float4)(scalar, fresnel_conductor_lanes(in[i].x, eta, k).s2, 0.0f, 0.0f);
}

// Direction and 1/eta, normal; to the reflected and the refracted direction and the reflectance.
kernel void bend(const global float4* in, global float4* out) {
    const size_t i = get_global_id(0);
    const float3 direction = in[2 * i].xyz, n = in[2 * i + 1].xyz;
    const float inverse_eta = in[2 * i].w, cos_i = min(-dot(direction, n), 1.0f);
    float cos_t;
    const float reflectance = fresnel_dielectric(cos_i, inverse_eta, &cos_t);
    out[2 * i] = (float4)(reflect(direction, n, cos_i), reflectance);
    out[2 * i + 1] = (float4)(refract(direction, n, inverse_eta, cos_i, cos_t), cos_t);
}

// Direction and eta, normal; to the direction after 64 parallel slabs.
kernel void slabs(const global float4* in, global float4* out) {
    const size_t i = get_global_id(0);
    const float3 n = in[2 * i + 1].xyz;
    float3 d = in[2 * i].xyz;
    for (int face = 0; face < 128; ++face) {
        const float inverse_eta = face % 2 == 0 ? 1.0f / in[2 * i].w : in[2 * i].w;
        const float cos_i = min(-dot(d, n), 1.0f);
        float cos_t;
        fresnel_dielectric(cos_i, inverse_eta, &cos_t);
        d = refract(d, n, inverse_eta, cos_i, cos_t);
    }
    out[i] = (float4)(d, 0.0f);
}

// Direction, normals of two mirrors; to the direction after each has reflected it 1, 4, 16, 64 and 256 times.
kernel void mirrors(const global float4* in, global float4* out) {
    const size_t i = get_global_id(0);
    float3 d = in[3 * i].xyz;
    size_t next = 5 * i;
    for (int pair = 0; pair < 256; ++pair) {
        for (int mirror = 1; mirror <= 2; ++mirror) {
            const float3 n = in[3 * i + mirror].xyz;
            const float cosine = -dot(d, n);
            d = reflect(d, cosine < 0.0f ? -n : n, min(fabs(cosine), 1.0f));
        }
        if (pair == 0 || pair == 3 || pair == 15 || pair == 63 || pair == 255)
            out[next++] = (float4)(d, 0.0f);
    }
}

// Normal, vector; to its frame's s and t, and the vector taken to the frame and back.
kernel void frames(const global float4* in, global float4* out) {
    const size_t i = get_global_id(0);
    const Frame frame = make_frame(in[2 * i].xyz);
    out[3 * i] = (float4)(frame.s, 0.0f);
    out[3 * i + 1] = (float4)(frame.t, 0.0f);
    out[3 * i + 2] = (float4)(frame_to_world(&frame, frame_from_world(&frame, in[2 * i + 1].xyz)), 0.0f);
}

kernel void octahedral(const global float4* in, global float4* out) {
    const size_t i = get_global_id(0);
    out[i] = (float4)(unpack_normal(pack_normal(in[i].xyz)), 0.0f);
}

// (u.x, u.y) to (disc, triangle), cosine hemisphere, sphere.
kernel void samples(const global float4* in, global float4* out) {
    const size_t i = get_global_id(0);
    const float2 u = in[i].xy;
    out[3 * i] = (float4)(sample_disc(u), sample_triangle(u));
    out[3 * i + 1] = (float4)(sample_cosine_hemisphere(u), 0.0f);
    out[3 * i + 2] = (float4)(sample_sphere(u), 0.0f);
}

// wo and eta, (alpha, u). To a sampled facet and its density; the direction that it reflects wo to, its weight, its pdf and the
// value and pdf that are evaluated for the two directions; the same for refraction, whose value is 0 without any.
kernel void facets(const global float4* in, global float4* out) {
    const size_t i = get_global_id(0);
    const float3 wo = in[2 * i].xyz;
    const float eta = in[2 * i].w, inverse_eta = 1.0f / eta;
    const float2 alpha = in[2 * i + 1].xy;
    const float3 m = sample_ggx_visible_normal(wo, alpha, in[2 * i + 1].zw);
    const float cos_i = clamp(dot(wo, m), 0.0f, 1.0f);
    out[5 * i] = (float4)(m, ggx_visible_normal_pdf(wo, m, alpha));

    float3 facet = (float3)(0.0f, 0.0f, 1.0f);
    const float3 mirrored = reflect(-wo, m, cos_i);
    out[5 * i + 1] = (float4)(mirrored, ggx_visible_normal_weight(wo, mirrored, alpha));
    const float reflection = ggx_reflection(wo, mirrored, alpha, &facet);
    out[5 * i + 2] = (float4)(ggx_reflection_pdf(wo, m, alpha), reflection, ggx_reflection_pdf(wo, facet, alpha), 0.0f);

    float cos_t;
    fresnel_dielectric(cos_i, inverse_eta, &cos_t);
    const float3 through = refract(-wo, m, inverse_eta, cos_i, cos_t);
    out[5 * i + 3] = (float4)(through, ggx_visible_normal_weight(wo, through, alpha));
    facet = (float3)(0.0f, 0.0f, 1.0f);
    const float refraction = cos_t > 0.0f ? ggx_refraction(wo, through, eta, alpha, &facet) : 0.0f;
    out[5 * i + 4] = (float4)(ggx_refraction_pdf(wo, through, m, eta, alpha), refraction,
                              refraction > 0.0f ? ggx_refraction_pdf(wo, through, facet, eta, alpha) : 0.0f, cos_t);
}
