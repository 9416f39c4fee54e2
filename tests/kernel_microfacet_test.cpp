// Densities and scattering of kernels/microfacet.h against formulas in double and against integrals that are known.

#include "microfacet_oracle.h"

#include <gtest/gtest.h>

namespace tristim {
namespace {

using namespace kernel_test;

const char* const microfacet_source = R"(
#include "microfacet.h"
kernel void facets(const global float4* wo, const global float4* m, const global float2* alpha, global float4* out) {
    const size_t i = get_global_id(0);
    out[i] = (float4)(ggx_distribution(m[i].xyz, alpha[i]), ggx_lambda(wo[i].xyz, alpha[i]),
                      ggx_masking(wo[i].xyz, alpha[i]), ggx_visible_normal_pdf(wo[i].xyz, m[i].xyz, alpha[i]));
}
// wo[i].w is eta. Reflection where wi is above, refraction where it is below: (value, pdf, G2, weight) and the facet.
kernel void pairs(const global float4* wo, const global float4* wi, const global float2* alpha, global float4* out,
                  global float4* facet) {
    const size_t i = get_global_id(0);
    const float3 o = wo[i].xyz, w = wi[i].xyz;
    float3 m = (float3)(0.0f, 0.0f, 1.0f);
    float value, pdf;
    if (w.z > 0.0f) {
        value = ggx_reflection(o, w, alpha[i], &m);
        pdf = ggx_reflection_pdf(o, m, alpha[i]);
    } else {
        value = ggx_refraction(o, w, wo[i].w, alpha[i], &m);
        pdf = ggx_refraction_pdf(o, w, m, wo[i].w, alpha[i]);
    }
    out[i] = (float4)(value, pdf, ggx_masking_shadowing(o, w, alpha[i]), ggx_visible_normal_weight(o, w, alpha[i]));
    facet[i] = (float4)(m, 0.0f);
}
)";

const ::cl::Program& program() {
    static const ::cl::Program built = build_test_program(microfacet_source);
    return built;
}

/// A batch of the kernel `facets`.
struct Facets {
    std::vector<cl_float4> wo, m;
    std::vector<cl_float2> alpha;
    void add(const cl_float4& o, const cl_float4& facet, const cl_float2& a) {
        wo.push_back(o);
        m.push_back(facet);
        alpha.push_back(a);
    }
    std::vector<cl_float4> evaluate() const {
        const Buffer<cl_float4> out = make_buffer<cl_float4>(wo.size());
        run(program(), "facets", wo.size(), upload(wo), upload(m), upload(alpha), out);
        return out.read(test_device());
    }
};

/// A batch of the kernel `pairs`.
struct Pairs {
    std::vector<cl_float4> wo, wi;
    std::vector<cl_float2> alpha;
    std::vector<cl_float4> facets; ///< after evaluate()
    void add(const cl_float4& o, const cl_float4& i, const cl_float2& a) {
        wo.push_back(o);
        wi.push_back(i);
        alpha.push_back(a);
    }
    std::vector<cl_float4> evaluate() {
        const Buffer<cl_float4> out = make_buffer<cl_float4>(wo.size()), m = make_buffer<cl_float4>(wo.size());
        run(program(), "pairs", wo.size(), upload(wo), upload(wi), upload(alpha), out, m);
        facets = m.read(test_device());
        return out.read(test_device());
    }
};

TEST(KernelMicrofacet, DistributionAndMaskingAgreeWithDouble) {
    Facets batch;
    Random random(71);
    for (const cl_float2& alpha : alphas) {
        for (const double degrees : {0.0, 30.0, 60.0, 85.0, 89.0, 89.99}) {
            for (int i = 0; i < 200; ++i) {
                const Vec3 p = random.direction();
                const Vec3 m = normalized({alpha.s[0] * p[0], alpha.s[1] * p[1], std::abs(p[2])});
                batch.add(float4_of(at_angle(degrees, random(0.0, 1.0))), float4_of(m), alpha);
            }
        }
    }
    const std::vector<cl_float4> values = batch.evaluate();
    for (std::size_t i = 0; i < values.size(); ++i) {
        const Vec3 wo = vec3(batch.wo[i]), m = vec3(batch.m[i]);
        const Ggx ggx(batch.alpha[i]);
        const std::string at = fmt::format("alpha = ({}, {}), wo.z = {}, m.z = {}", ggx.u, ggx.v, wo[2], m[2]);
        const auto near = [&](int index, double expected, double units) {
            ASSERT_NEAR(values[i].s[index], expected, units * unit_roundoff * expected) << index << ": " << at;
        };
        near(0, ggx.distribution(m), distribution_units);
        // 4 u for the squared sine, 1 u more than a length's for the sum with z and 1 u for the product, 5 u to divide.
        near(1, ggx.lambda(wo), 4.0 + length_units + 2.0 + 5.0);
        near(2, ggx.masking(wo), length_units + 1.0 + 5.0);
        // Products, the sum z + length, and a division; wo·m is off by 3 u of the sum of its terms' sizes.
        const double scale = ggx.distribution(m) * ggx.masking(wo) / wo[2];
        ASSERT_NEAR(values[i].s[3], ggx.visible_pdf(wo, m),
                    unit_roundoff * ((distribution_units + length_units + 8.0) * ggx.visible_pdf(wo, m) +
                                     3.0 * scale * absolute_dot(wo, m)))
            << at;
    }
}

TEST(KernelMicrofacet, ReflectionAndRefractionAgreeWithDouble) {
    Pairs batch;
    Random random(72);
    const std::vector<float> etas{1.0F, 1.5F, 1.0F / 1.5F, 1.1F, 2.4F};
    for (const cl_float2& alpha : alphas) {
        for (const float eta : etas) {
            for (int i = 0; i < 400; ++i) {
                const Vec3 wo = at_angle(random(0.0, 89.5), random(0.0, 1.0)), p = random.direction();
                const Vec3 m = normalized({alpha.s[0] * p[0], alpha.s[1] * p[1], std::abs(p[2])});
                const double cos_i = dot(wo, m), cos2_t = 1.0 - (1.0 - cos_i * cos_i) / (double{eta} * eta);
                const double shift = eta == 1.0F ? 2.0 * cos_i : cos_i / eta - std::sqrt(std::max(cos2_t, 0.0));
                const Vec3 wi = normalized(shift * m - (1.0 / eta) * wo);
                // Far enough from the borders of what is possible for rounding to leave it possible.
                if (cos_i > 1e-3 && cos2_t > 1e-6 && (eta == 1.0F ? wi[2] : -wi[2]) > 1e-3)
                    batch.add(float4_of(wo, eta), float4_of(wi), alpha);
            }
        }
    }
    ASSERT_GT(batch.wo.size(), 7000U) << "most of 14,000 pairs are possible";
    const std::vector<cl_float4> values = batch.evaluate();
    for (std::size_t i = 0; i < values.size(); ++i) {
        const Vec3 wo = vec3(batch.wo[i]), wi = vec3(batch.wi[i]), facet = vec3(batch.facets[i]);
        const double eta = batch.wo[i].s[3];
        const Ggx ggx(batch.alpha[i]);
        const bool reflects = wi[2] > 0.0;
        const std::string at =
            fmt::format("alpha = ({}, {}), eta = {}, wo.z = {}, wi.z = {}", ggx.u, ggx.v, eta, wo[2], wi[2]);
        const auto near = [&](double value, double expected, double units) {
            ASSERT_NEAR(value, expected, units * unit_roundoff * std::abs(expected)) << at;
        };
        const Vec3 m = reflects ? Ggx::reflecting(wo, wi) : Ggx::refracting(wo, wi, eta);
        for (std::size_t k = 0; k < 3; ++k)
            near(facet[k], m[k], half_vector_units);
        // The sum of two products with lengths: 2 u more than a length.
        near(values[i].s[2], ggx.masking_shadowing(wo, wi), 1.0 + length_units + 2.0 + 5.0);
        near(values[i].s[3], ggx.masking_shadowing(wo, wi) / ggx.masking(wo), weight_units);
        if (reflects) {
            near(values[i].s[0], ggx.reflection(wo, wi), half_distribution_units + length_units + 2.0 + 1.0 + 5.0);
            near(values[i].s[1], ggx.reflection_pdf(wo, wi), half_distribution_units + length_units + 1.0 + 1.0 + 5.0);
            continue;
        }
        // Products with the facet: its error and the product's own 3 u, of the sum of the terms' sizes. The Jacobian's
        // denominator rounds once more; its quotient by 5 u, squares and products by 3 u.
        const double of_o = (half_vector_units + 3.0) * absolute_dot(wo, m);
        const double of_i = (half_vector_units + 3.0) * absolute_dot(wi, m);
        const double denominator = std::abs(eta * dot(wi, m) + dot(wo, m));
        const double jacobian_units =
            of_i / std::abs(dot(wi, m)) + 2.0 * ((eta * of_i + of_o) / denominator + 1.0 + 5.0) + 3.0;
        const double units =
            half_distribution_units + of_o / dot(wo, m) + jacobian_units + length_units + 2.0 + 3.0 + 5.0;
        near(values[i].s[0], ggx.refraction(wo, wi, eta), units);
        near(values[i].s[1], ggx.refraction_pdf(wo, wi, eta), units);
    }
}

/// ∫ D(m) m.z dm = 1, ∫ G1(wo) max(0, wo·m) D(m) dm = wo.z and the visible normals' density integrates to 1. On the
/// lune the right integrand is a polynomial of cosines, which the rule integrates exactly.
TEST(KernelMicrofacet, DistributionsAreNormalised) {
    const std::vector<Node> rule = gauss_legendre(24);
    Random random(73);
    for (const cl_float2& alpha : alphas) {
        for (const double degrees : {0.0, 30.0, 60.0, 80.0, 89.0, 89.99}) {
            const cl_float4 rounded = float4_of(at_angle(degrees, random(0.0, 1.0)));
            const Vec3 wo = vec3(rounded);
            const Lune lune(wo, alpha);
            Facets batch;
            std::vector<double> weights;
            for (const Node& s : rule) {
                for (const Node& t : rule) {
                    const auto [m, solid_angle] = lune.facet(s.x, t.x);
                    batch.add(rounded, float4_of(m), alpha);
                    weights.push_back(s.weight * t.weight * solid_angle);
                }
            }
            const std::vector<cl_float4> values = batch.evaluate();
            double projected = 0.0, visible = 0.0, pdf = 0.0, rounding = 0.0;
            for (std::size_t i = 0; i < values.size(); ++i) {
                const Vec3 m = vec3(batch.m[i]);
                const double distribution = weights[i] * values[i].s[0];
                projected += distribution * m[2];
                visible += distribution * values[i].s[2] * std::max(0.0, dot(wo, m));
                pdf += weights[i] * values[i].s[3];
                // The facet was rounded: 1 u of each component, 4 u of D.
                rounding += unit_roundoff * distribution * values[i].s[2] / wo[2] *
                            ((distribution_units + length_units + 8.0 + 4.0) * std::max(0.0, dot(wo, m)) +
                             (3.0 + 1.0) * absolute_dot(wo, m));
            }
            if (degrees == 0.0) {
                EXPECT_NEAR(projected, 1.0, rounding) << name(alpha, degrees);
            }
            EXPECT_NEAR(visible / wo[2], 1.0, rounding) << name(alpha, degrees);
            EXPECT_NEAR(pdf, 1.0, rounding) << name(alpha, degrees);
        }
    }
}

/// f(wo, wi) = f(wi, wo) for reflection, and η² f(wi, wo, 1/η) for refraction, with the frame turned round.
TEST(KernelMicrofacet, IsReciprocal) {
    Pairs forward, backward;
    Random random(78);
    for (const cl_float2& alpha : {cl_float2{{0.05F, 0.05F}}, cl_float2{{1.0F, 1.0F}}, cl_float2{{0.1F, 0.6F}}}) {
        for (const float eta : {1.0F, 2.0F, 0.5F}) { // whose inverses are exact
            for (int i = 0; i < 2000; ++i) {
                const cl_float4 wo = float4_of(at_angle(random(0.0, 85.0), random(0.0, 1.0)), eta);
                cl_float4 wi = float4_of(at_angle(random(0.0, 85.0), random(0.0, 1.0)), 1.0F / eta);
                cl_float4 from = wi, to = wo;
                if (eta != 1.0F) {
                    wi.s[2] = -wi.s[2];
                    to.s[2] = -to.s[2];
                }
                forward.add(wo, wi, alpha);
                backward.add(from, to, alpha);
            }
        }
    }
    const std::vector<cl_float4> there = forward.evaluate(), back = backward.evaluate();
    int refracted = 0;
    for (std::size_t i = 0; i < there.size(); ++i) {
        const Vec3 wo = vec3(forward.wo[i]), wi = vec3(forward.wi[i]), m = vec3(forward.facets[i]);
        const double eta = forward.wo[i].s[3];
        double units = half_distribution_units + length_units + 8.0;
        if (eta != 1.0) {
            // As in the comparison with double, each product with m at most off by 18.5 u; |η wi·m + wo·m| >= |η - 1|.
            const double product = half_vector_units + 3.0;
            units += product * (1.0 / std::abs(dot(wi, m)) + 1.0 / std::abs(dot(wo, m))) +
                     2.0 * (product * (eta + 1.0) / std::abs(eta - 1.0) + 6.0) + 5.0;
            refracted += there[i].s[0] > 0.0F ? 1 : 0;
        }
        ASSERT_NEAR(there[i].s[0], eta * eta * back[i].s[0], 2.0 * units * unit_roundoff * there[i].s[0])
            << "eta = " << eta << ", wo.z = " << wo[2] << ", wi.z = " << wi[2];
    }
    EXPECT_GT(refracted, 1000);
}

} // namespace
} // namespace tristim
