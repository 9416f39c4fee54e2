// The samplers of kernels/microfacet.h against their densities.

#include "microfacet_oracle.h"

#include <gtest/gtest.h>

namespace tristim {
namespace {

using namespace kernel_test;
using std::numbers::pi;

const char* const microfacet_sampling_source = R"(
#include "microfacet.h"
#include "optics.h"
kernel void sample_normals(float4 wo, float2 alpha, const global float2* u, global float4* m) {
    const size_t i = get_global_id(0);
    m[i] = (float4)(sample_ggx_visible_normal(wo.xyz, alpha, u[i]), 0.0f);
}
// wo.w is eta, 1 for reflection. (wi, weight), all 0 where the sampled facet leads to the wrong side.
kernel void sample_directions(float4 wo, float2 alpha, const global float2* u, global float4* out) {
    const size_t i = get_global_id(0);
    const float3 m = sample_ggx_visible_normal(wo.xyz, alpha, u[i]);
    const float cos_i = clamp(dot(wo.xyz, m), 0.0f, 1.0f), inverse_eta = 1.0f / wo.w;
    float3 wi = reflect(-wo.xyz, m, cos_i);
    bool valid = wi.z > 0.0f;
    if (wo.w != 1.0f) {
        float cos_t;
        fresnel_dielectric(cos_i, inverse_eta, &cos_t);
        wi = refract(-wo.xyz, m, inverse_eta, cos_i, cos_t);
        valid = cos_t > 0.0f && wi.z < 0.0f;
    }
    out[i] = valid ? (float4)(wi, ggx_visible_normal_weight(wo.xyz, wi, alpha)) : (float4)(0.0f);
}
// What the facet m does with light, the mirrored direction above and its image below the surface: (value, pdf, G2, weight) of
// each.
kernel void scatter(float4 wo, float2 alpha, const global float4* m, global float4* out) {
    const size_t i = get_global_id(0);
    const float3 mirrored = reflect(-wo.xyz, m[i].xyz, max(dot(wo.xyz, m[i].xyz), 0.0f));
    for (int k = 0; k < 2; ++k) {
        const float3 wi = (float3)(mirrored.xy, k == 0 ? mirrored.z : -fabs(mirrored.z));
        float3 facet = (float3)(0.0f, 0.0f, 1.0f);
        const float value = k == 0 ? ggx_reflection(wo.xyz, wi, alpha, &facet) : ggx_refraction(wo.xyz, wi, wo.w, alpha, &facet);
        float pdf = ggx_reflection_pdf(wo.xyz, facet, alpha);
        if (k == 1) // of facets that refract
            pdf = value > 0.0f ? ggx_refraction_pdf(wo.xyz, wi, facet, wo.w, alpha) : 0.0f;
        out[2 * i + k] = (float4)(value, pdf, ggx_masking_shadowing(wo.xyz, wi, alpha),
                                  ggx_visible_normal_weight(wo.xyz, wi, alpha));
    }
}
)";

const ::cl::Program& program() {
    static const ::cl::Program built = build_test_program(microfacet_sampling_source);
    return built;
}

TEST(KernelMicrofacetSampling, VisibleNormalsFollowTheirPdf) {
    constexpr std::size_t samples = 1 << 16, side = 16;
    const std::vector<Node> rule = gauss_legendre(6);
    std::uint32_t seed = 7400;
    for (const cl_float2& alpha : alphas) {
        for (const double degrees : {0.0, 60.0, 89.0, 89.99}) {
            const cl_float4 wo = float4_of(at_angle(degrees, 0.15));
            const Buffer<cl_float4> out = make_buffer<cl_float4>(samples);
            run(program(), "sample_normals", samples, wo, alpha, upload(random_squares(samples, ++seed)), out);
            const Lune lune(vec3(wo), alpha);
            const Ggx ggx(alpha);
            Histogram histogram(side * side);
            for (const cl_float4& m : out.read(test_device())) {
                const auto [s, t] = lune.square(vec3(m));
                histogram.add(Histogram::bin(s, side) * side + Histogram::bin(t, side));
            }
            std::vector<double> probabilities;
            double total = 0.0;
            for (std::size_t i = 0; i < side * side; ++i) {
                const double s = static_cast<double>(i / side) / side, t = static_cast<double>(i % side) / side;
                probabilities.push_back(integral(rule, {s, s + 1.0 / side, t, t + 1.0 / side}, [&](double x, double y) {
                    const auto [m, solid_angle] = lune.facet(x, y);
                    return ggx.visible_pdf(vec3(wo), m) * solid_angle;
                }));
                total += probabilities.back();
            }
            EXPECT_NEAR(total, 1.0, 1e-9) << "the oracle itself: " << name(alpha, degrees);
            histogram.expect_distribution("visible normals, " + name(alpha, degrees), probabilities);
        }
    }
}

/// Directions on one side as angles (from the normal or its opposite, around it from the plane of incidence).
struct Around {
    double cosine = 1.0, sine = 0.0;
    explicit Around(const Vec3& wo) {
        if (const double across = std::hypot(wo[0], wo[1]); across > 1e-6) {
            cosine = -wo[0] / across;
            sine = -wo[1] / across;
        }
    }
    std::array<double, 2> angles(const Vec3& w) const {
        return {std::atan2(std::hypot(w[0], w[1]), std::abs(w[2])),
                std::atan2(w[1] * cosine - w[0] * sine, w[0] * cosine + w[1] * sine)};
    }
    Vec3 direction(double theta, double phi, double sign) const {
        const double x = std::sin(theta) * std::cos(phi), y = std::sin(theta) * std::sin(phi);
        return {x * cosine - y * sine, x * sine + y * cosine, sign * std::cos(theta)};
    }
};

std::vector<cl_float4> sample_directions(const cl_float4& wo_and_eta, const cl_float2& alpha, std::size_t samples,
                                         std::uint32_t seed) {
    const Buffer<cl_float4> out = make_buffer<cl_float4>(samples);
    run(program(), "sample_directions", samples, wo_and_eta, alpha, upload(random_squares(samples, seed)), out);
    return out.read(test_device());
}

/// Edges that put as many samples into each of `bins` intervals.
std::vector<double> quantiles(std::vector<double> samples, std::size_t bins, double low, double high) {
    std::sort(samples.begin(), samples.end());
    std::vector<double> edges{low};
    for (std::size_t i = 1; i < bins; ++i)
        edges.push_back(samples[i * samples.size() / bins]);
    edges.push_back(high);
    return edges;
}
std::size_t interval(const std::vector<double>& edges, double x) {
    const auto above = std::upper_bound(edges.begin() + 1, edges.end() - 1, x);
    return static_cast<std::size_t>(above - edges.begin()) - 1;
}

/// Bins follow the lobe: half of the samples place their edges, the other half is tested. A last bin takes what goes to
/// the wrong side.
void expect_directions(const cl_float2& alpha, double degrees, float eta, std::uint32_t seed) {
    constexpr std::size_t samples = 1 << 16, side = 12;
    const cl_float4 rounded = float4_of(at_angle(degrees, 0.15), eta);
    const Vec3 wo = vec3(rounded);
    const Around around(wo);
    const Ggx ggx(alpha);
    std::vector<double> thetas, phis;
    for (const cl_float4& wi : sample_directions(rounded, alpha, samples, seed)) {
        if (wi.s[2] != 0.0F) {
            const auto [theta, phi] = around.angles(vec3(wi));
            thetas.push_back(theta);
            phis.push_back(phi);
        }
    }
    const std::vector<double> theta_edges = quantiles(thetas, side, 0.0, pi / 2.0);
    const std::vector<double> phi_edges = quantiles(phis, side, -pi, pi);
    Histogram histogram(side * side + 1);
    for (const cl_float4& wi : sample_directions(rounded, alpha, samples, seed + 1)) {
        const auto [theta, phi] = around.angles(vec3(wi));
        histogram.add(wi.s[2] == 0.0F ? side * side : interval(theta_edges, theta) * side + interval(phi_edges, phi));
    }
    std::vector<double> probabilities;
    double total = 0.0;
    for (std::size_t i = 0; i < side; ++i) {
        for (std::size_t j = 0; j < side; ++j) {
            const auto pdf = [&](double theta, double phi) {
                const Vec3 wi = around.direction(theta, phi, eta == 1.0F ? 1.0 : -1.0);
                return std::sin(theta) * (eta == 1.0F ? ggx.reflection_pdf(wo, wi) : ggx.refraction_pdf(wo, wi, eta));
            };
            probabilities.push_back(
                adaptive_integral({theta_edges[i], theta_edges[i + 1], phi_edges[j], phi_edges[j + 1]}, pdf));
            total += probabilities.back();
        }
    }
    probabilities.push_back(std::max(0.0, 1.0 - total));
    histogram.expect_distribution(fmt::format("directions, {}, eta = {}", name(alpha, degrees), eta), probabilities);
}

const std::vector<cl_float2> lobe_alphas{{{0.05F, 0.05F}}, {{0.3F, 0.3F}}, {{1.0F, 1.0F}}, {{0.1F, 0.6F}}};

TEST(KernelMicrofacetSampling, ReflectedDirectionsFollowTheirPdf) {
    std::uint32_t seed = 7500;
    for (const cl_float2& alpha : lobe_alphas) {
        for (const double degrees : {0.0, 60.0, 89.0})
            expect_directions(alpha, degrees, 1.0F, seed += 2);
    }
}

TEST(KernelMicrofacetSampling, RefractedDirectionsFollowTheirPdf) {
    std::uint32_t seed = 7600;
    for (const cl_float2& alpha : lobe_alphas) {
        for (const float eta : {1.5F, 1.0F / 1.5F}) {
            for (const double degrees : {0.0, 35.0, 80.0})
                expect_directions(alpha, degrees, eta, seed += 2);
        }
    }
}

/// The mean weight of sampled directions is the surface's albedo without Fresnel's share, ∫ f |wi.z| dwi: less than 1,
/// as light that meets a second facet is left out.
TEST(KernelMicrofacetSampling, WeightsAddUpToTheAlbedo) {
    constexpr std::size_t samples = 1 << 16;
    std::uint32_t seed = 7700;
    for (const cl_float2& alpha : {cl_float2{{0.2F, 0.2F}}, cl_float2{{1.0F, 1.0F}}, cl_float2{{0.15F, 0.6F}}}) {
        for (const float eta : {1.0F, 1.5F, 1.0F / 1.5F}) {
            for (const double degrees : {0.0, 30.0, 70.0}) {
                const cl_float4 wo = float4_of(at_angle(degrees, 0.15), eta);
                const Around around(vec3(wo));
                const Ggx ggx(alpha);
                const double albedo = adaptive_integral({0.0, pi / 2.0, -pi, pi}, [&](double theta, double phi) {
                    const Vec3 wi = around.direction(theta, phi, eta == 1.0F ? 1.0 : -1.0);
                    return std::sin(theta) * std::cos(theta) *
                           (eta == 1.0F ? ggx.reflection(vec3(wo), wi) : ggx.refraction(vec3(wo), wi, eta));
                });
                ASSERT_LT(albedo, 1.0);
                Moments weight;
                for (const cl_float4& direction : sample_directions(wo, alpha, samples, ++seed))
                    weight.add(direction.s[3]);
                expect_mean(fmt::format("albedo, {}, eta = {}", name(alpha, degrees), eta), weight.mean(), albedo,
                            weight.standard_error());
            }
        }
    }
}

/// The borders of what may come in: grazing directions to the last, extreme roughness, the unit square's corners.
TEST(KernelMicrofacetSampling, StaysFiniteAtTheBorders) {
    const std::vector<float> border{0.0F, 0x1p-24F, 0.25F, 0.5F, 0.75F, 1.0F - 0x1p-24F};
    std::vector<cl_float2> squares;
    for (const float x : border) {
        for (const float y : border)
            squares.push_back({{x, y}});
    }
    const std::vector<cl_float2> random = random_squares(4096, 79);
    squares.insert(squares.end(), random.begin(), random.end());
    for (const cl_float2& alpha : alphas) {
        for (const float z : {0.0F, 1e-38F, 1e-20F, 1e-7F, 1e-3F, 1.0F}) {
            for (const double turns : {0.0, 0.25, 0.15}) {
                const Vec3 horizontal = at_angle(90.0, turns);
                const double across = std::sqrt(1.0 - double{z} * z);
                const cl_float4 wo = float4_of({across * horizontal[0], across * horizontal[1], z}, 1.5);
                const std::string at = fmt::format("alpha = ({}, {}), wo.z = {}", alpha.s[0], alpha.s[1], z);
                const Buffer<cl_float4> out = make_buffer<cl_float4>(squares.size());
                run(program(), "sample_normals", squares.size(), wo, alpha, upload(squares), out);
                std::vector<cl_float4> facets = out.read(test_device());
                for (const cl_float4& rounded : facets) {
                    const Vec3 m = vec3(rounded);
                    ASSERT_NEAR(length(m), 1.0, half_vector_units * unit_roundoff) << at;
                    ASSERT_GT(m[2], 0.0) << at;
                    ASSERT_GE(dot(vec3(wo), m), -half_vector_units * unit_roundoff) << at;
                }
                facets.push_back({{0.0F, 0.0F, 1.0F, 0.0F}}); // which mirrors the horizontal to the horizontal
                const Buffer<cl_float4> scattered = make_buffer<cl_float4>(2 * facets.size());
                run(program(), "scatter", facets.size(), wo, alpha, upload(facets), scattered);
                for (const cl_float4& values : scattered.read(test_device())) {
                    ASSERT_TRUE(std::isfinite(values.s[0]) && values.s[0] >= 0.0F) << values.s[0] << ", " << at;
                    ASSERT_TRUE(std::isfinite(values.s[1]) && values.s[1] >= 0.0F) << values.s[1] << ", " << at;
                    for (const int i : {2, 3}) { // G2 and the weight
                        ASSERT_GE(values.s[i], 0.0F) << at;
                        ASSERT_LE(values.s[i], 1.0 + weight_units * unit_roundoff) << at;
                    }
                }
            }
        }
    }
}

} // namespace
} // namespace tristim
