// The GGX distribution: what is sampled, and the densities and values of it.

#include "selftest/optics_cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tristim::selftest {
namespace {

using namespace optics;

struct FacetInput {
    Vector wo; ///< as rounded
    float eta;
    float alpha_u, alpha_v;
    cl_float4 first, second; ///< what the kernel reads
    Ggx ggx() const { return {alpha_u, alpha_v}; }
    std::string describe() const {
        return fmt::format("wo = ({:.9g}, {:.9g}, {:.9g}), eta = {:.9g}, alpha = ({}, {}), u = ({:.9g}, {:.9g})",
                           first.s[0], first.s[1], first.s[2], eta, alpha_u, alpha_v, second.s[2], second.s[3]);
    }
};

/// What the kernel `facets` says.
struct FacetOutput {
    Vector m, mirrored, through;
    Real normal_pdf;
    Real mirrored_weight, mirrored_pdf, reflection, reflection_pdf;
    Real through_weight, through_pdf, refraction, refraction_pdf, cos_t;
};

/// Calls judge(input, output) for random numbers at each roughness, cosine of wo and eta.
template <typename Judge>
void sample(const Setting& setting, const ::cl::Program& program, const std::vector<float>& alphas,
            const std::vector<float>& wo_cosines, const std::vector<float>& etas, std::size_t count, Judge&& judge) {
    Random random(8);
    std::vector<FacetInput> list;
    for (const float alpha : alphas) {
        for (const float cosine : wo_cosines) {
            for (const float eta : etas) {
                for (std::size_t i = 0; i < inputs(setting, static_cast<std::size_t>(count), 2); ++i) {
                    const Real phi = 2.0L * std::numbers::pi_v<Real> * random();
                    const Real sine = std::sqrt((1.0L - cosine) * (1.0L + cosine));
                    // Ends of the unit square first, then numbers in it; every fourth surface is anisotropic.
                    const float end = 1.0F - 0x1p-24F;
                    const float x = i < 4 ? (i % 2 == 0 ? 0.0F : end) : random.unit_float();
                    const float y = i < 4 ? (i < 2 ? 0.0F : end) : random.unit_float();
                    FacetInput input{{}, eta, alpha, i % 4 == 3 ? std::min(1.0F, 10.0F * alpha) : alpha, {}, {}};
                    input.first = float4_of(Vector{sine * std::cos(phi), sine * std::sin(phi), cosine}, eta);
                    input.second = float4_of(input.alpha_u, input.alpha_v, x, y);
                    input.wo = vector_of(input.first);
                    list.push_back(input);
                }
            }
        }
    }
    std::vector<cl_float4> in;
    for (const FacetInput& input : list) {
        in.push_back(input.first);
        in.push_back(input.second);
    }
    const std::vector<cl_float4> out = run(setting, program, "facets", in, 2, 5);
    for (std::size_t i = 0; i < list.size(); ++i) {
        const cl_float4* o = out.data() + 5 * i;
        judge(list[i], FacetOutput{vector_of(o[0]), vector_of(o[1]), vector_of(o[3]), o[0].s[3], o[1].s[3], o[2].s[0],
                                   o[2].s[1], o[2].s[2], o[3].s[3], o[4].s[0], o[4].s[1], o[4].s[2], o[4].s[3]});
    }
}

const std::vector<float> alphas{1e-4F, 3e-4F, 1e-3F, 3e-3F, 0.01F, 0.03F, 0.1F, 0.3F, 1.0F};
const std::vector<float> grazing{1.0F, 0.9F, 0.5F, 0.1F, 0.01F, 1e-3F, 1e-4F, 1e-5F, 1e-6F, 1e-7F, 1e-8F};

Real relative(Real value, Real exact) {
    return std::abs(value / exact - 1.0L);
}

/// Σ |a_k b_k|: a product of vectors that are right to a unit is right to as many units of this.
Real absolute_dot(const Vector& a, const Vector& b) {
    return std::abs(a[0] * b[0]) + std::abs(a[1] * b[1]) + std::abs(a[2] * b[2]);
}

Measurement visible_normals(const Setting& setting, const ::cl::Program& program) {
    Measurement found;
    sample(setting, program, alphas, grazing, {1.5F}, 64, [&](const FacetInput& in, const FacetOutput& out) {
        const Real cosine = dot(in.wo, out.m);
        Real error = std::abs(length(out.m) - 1.0L) + std::max(0.0L, -out.m[2]) + std::max(0.0L, -cosine - 2e-6L);
        if (cosine > 0.0L)
            error += relative(out.normal_pdf, in.ggx().visible_pdf(in.wo, out.m)) * cosine / absolute_dot(in.wo, out.m);
        found.add(in.first.s[2], static_cast<double>(error), [&] { return in.describe(); });
    });
    return found;
}

Measurement weights(const Setting& setting, const ::cl::Program& program) {
    Measurement found;
    sample(setting, program, alphas, grazing, {0.1F, 0.5F, 1.5F, 10.0F}, 32,
           [&](const FacetInput& in, const FacetOutput& out) {
               const auto judge = [&](const Vector& wi, Real weight) {
                   Real error = relative(weight, in.ggx().weight(in.wo, wi)) + std::max(0.0L, weight - 1.0L);
                   found.add(in.first.s[2], static_cast<double>(error), [&] { return in.describe(); });
               };
               if (out.mirrored[2] > 0.0L)
                   judge(out.mirrored, out.mirrored_weight);
               if (out.cos_t > 0.0L && out.through[2] < 0.0L)
                   judge(out.through, out.through_weight);
           });
    return found;
}

/// Value and pdf of two directions, which are what they are.
Measurement reflection_values(const Setting& setting, const ::cl::Program& program) {
    Measurement found;
    sample(setting, program, alphas, grazing, {1.5F}, 64, [&](const FacetInput& in, const FacetOutput& out) {
        if (out.mirrored[2] <= 1e-18L)
            return;
        const Vector m = normalized(in.wo + out.mirrored);
        const Real error = std::max(relative(out.reflection, in.ggx().reflection(in.wo, out.mirrored)),
                                    relative(out.reflection_pdf, in.ggx().reflection_pdf(in.wo, m)));
        found.add(in.first.s[2], static_cast<double>(error), [&] { return in.describe(); });
    });
    return found;
}

/// The pdf of a sampled direction against that which the direction has. The rounding of wi turns the facet by some
/// units over 2 wo·m, of which slopes make 1/α.
Measurement sampled_reflection(const Setting& setting, const ::cl::Program& program) {
    Measurement found;
    sample(setting, program, alphas, grazing, {1.5F}, 64, [&](const FacetInput& in, const FacetOutput& out) {
        if (out.mirrored[2] <= 1e-18L)
            return;
        const Vector m = normalized(in.wo + out.mirrored);
        const Real condition = 1.0L + 1.0L / (in.alpha_u * std::max(2.0L * dot(in.wo, m), 0x1p-19L));
        const Real error = relative(out.mirrored_pdf, in.ggx().reflection_pdf(in.wo, m)) / condition;
        found.add(in.alpha_u, static_cast<double>(error), [&] { return in.describe(); });
    });
    return found;
}

std::vector<float> nearly_matched() {
    std::vector<float> etas;
    for (const float step : ratio_steps(1e-7, 0.5, 20)) {
        etas.push_back(1.0F + step);
        etas.push_back(1.0F - step);
    }
    return etas;
}

/// The pdf of a refracted direction, given the facet. wo·m is a dot product's error off, and cos² θ_t as well, and the
/// rounding of 1/eta.
Measurement sampled_refraction(const Setting& setting, const ::cl::Program& program) {
    Measurement found;
    sample(setting, program, {1e-4F, 0.01F, 0.3F, 1.0F}, {1.0F, 0.5F, 0.1F, 0.01F}, nearly_matched(), 32,
           [&](const FacetInput& in, const FacetOutput& out) {
               if (out.cos_t <= 0.0L || out.through[2] >= 0.0L)
                   return;
               const Real cosine = dot(in.wo, out.m), cos_t = refraction_cosine(cosine, in.eta);
               const Real error = relative(out.through_pdf, in.ggx().refraction_pdf(in.wo, out.m, in.eta)) *
                                  std::min(cosine, cos_t * cos_t);
               found.add(in.eta - 1.0, static_cast<double>(error), [&] { return in.describe(); });
           });
    return found;
}

/// Value and pdf of refraction where indices match or nearly so: finite, and consistent with one another.
Measurement matched_refraction(const Setting& setting, const ::cl::Program& program) {
    std::vector<float> etas = nearly_matched();
    etas.push_back(1.0F);
    Measurement found;
    sample(setting, program, {1e-4F, 0.01F, 0.3F, 1.0F}, grazing, etas, 8,
           [&](const FacetInput& in, const FacetOutput& out) {
               const bool finite = std::isfinite(out.through_pdf) && out.through_pdf >= 0.0L &&
                                   std::isfinite(out.refraction) && std::isfinite(out.refraction_pdf);
               Real error = finite ? 0.0L : INFINITY;
               if (finite && out.refraction > 0.0L && out.through[2] < -1e-18L) {
                   // f |wi.z| / pdf is the weight of the direction.
                   const Real weight = out.refraction * std::abs(out.through[2]) / out.refraction_pdf;
                   error = relative(weight, in.ggx().weight(in.wo, out.through));
               }
               found.add(in.eta - 1.0, static_cast<double>(error), [&] { return in.describe(); });
           });
    return found;
}

} // namespace

std::vector<Case> microfacet_cases(const Programs& cores) {
    const auto with = [&cores](Measurement (*measure)(const Setting&, const ::cl::Program&)) {
        return [cores, measure](const Setting& setting) { return measure(setting, cores(setting)); };
    };
    return {{"optics", "visible normals, alpha 1e-4 to 1", "wo.z", "pdf, relative to its terms", 2e-6, 2e-6,
             with(visible_normals)},
            {"optics", "rough weights, alpha 1e-4 to 1", "wo.z", "weight, relative, and above 1", 1e-6, 1e-6,
             with(weights)},
            {"optics", "rough reflection, alpha 1e-4 to 1", "wo.z", "value and pdf, relative", 4e-6, 4e-6,
             with(reflection_values)},
            {"optics", "pdf of sampled reflections", "alpha", "relative / (1 + 1/(2 alpha wo·m))", 4e-6, 4e-6,
             with(sampled_reflection)},
            {"optics", "pdf of sampled refractions, eta near 1", "eta - 1", "relative · min(wo·m, cos² θ_t)", 2e-6,
             2e-6, with(sampled_refraction)},
            {"optics", "rough refraction, eta 1 and near it", "eta - 1", "value over pdf, relative", 1e-6, 1e-6,
             with(matched_refraction)}};
}

} // namespace tristim::selftest
