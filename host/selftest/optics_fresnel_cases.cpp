// Fresnel's equations and the angle of refraction.

#include "selftest/optics_cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tristim::selftest {
namespace {

using namespace optics;

struct DielectricInput {
    float cosine;
    float inverse; ///< n_i/n_t
    float curve;   ///< the curve's parameter
    Real n() const { return 1.0L / static_cast<Real>(inverse); }
};

/// Calls judge(input, reflectance, cos_t) for each of the inputs.
template <typename Judge>
void evaluate(const Setting& setting, const ::cl::Program& program, const std::vector<DielectricInput>& inputs,
              Judge&& judge) {
    std::vector<cl_float4> in;
    for (const DielectricInput& input : inputs)
        in.push_back(float4_of(input.cosine, input.inverse));
    const std::vector<cl_float4> out = run(setting, program, "dielectric", in, 1, 1);
    for (std::size_t i = 0; i < inputs.size(); ++i)
        judge(inputs[i], static_cast<Real>(out[i].s[0]), static_cast<Real>(out[i].s[1]));
}

std::string describe(const DielectricInput& input) {
    return fmt::format("cos = {:.9g}, 1/eta = {:.9g}", input.cosine, input.inverse);
}

/// The cosine of the critical angle, or -1.
double critical_cosine(float inverse) {
    return inverse > 1.0F ? std::sqrt(1.0 - 1.0 / (static_cast<double>(inverse) * inverse)) : -1.0;
}

/// Cosines off those of the critical angle by 1e-7 to 1e-2 either way.
std::vector<DielectricInput> around_critical(float inverse) {
    std::vector<DielectricInput> inputs;
    const double critical = critical_cosine(inverse);
    for (const float step : ratio_steps(1e-7, 1e-2, 20)) {
        for (const float sign : {-1.0F, 1.0F}) {
            const double cosine = critical + sign * step;
            if (critical >= 0.0 && cosine > 0.0 && cosine <= 1.0)
                inputs.push_back({static_cast<float>(cosine), inverse, sign * step});
        }
    }
    return inputs;
}

/// The range of both, with the index as the curve's parameter.
std::vector<DielectricInput> all_angles(const std::vector<float>& etas) {
    std::vector<DielectricInput> inputs;
    for (const float eta : etas) {
        const float inverse = 1.0F / eta;
        for (const float cosine : cosines())
            inputs.push_back({cosine, inverse, eta});
        for (DielectricInput input : around_critical(inverse)) {
            input.curve = eta;
            inputs.push_back(input);
        }
    }
    return inputs;
}

Measurement cosine_squared(const Setting& setting, const ::cl::Program& program) {
    Measurement found;
    evaluate(setting, program, all_angles(relative_indices()), [&](const auto& input, Real, Real cos_t) {
        const Real q = normal_component(input.cosine, input.n()).real() / input.n();
        found.add(input.curve, static_cast<double>(std::abs(cos_t * cos_t - q * q)), [&] { return describe(input); });
    });
    return found;
}

Measurement entering_cosine(const Setting& setting, const ::cl::Program& program) {
    std::vector<DielectricInput> inputs;
    for (const float eta : relative_indices()) {
        for (const float cosine : cosines()) {
            if (eta >= 1.0F && cosine > 0.0F)
                inputs.push_back({cosine, 1.0F / eta, cosine});
        }
    }
    Measurement found;
    evaluate(setting, program, inputs, [&](const auto& input, Real, Real cos_t) {
        found.add(input.curve, static_cast<double>(std::abs(cos_t / refraction_cosine(input.cosine, input.n()) - 1.0L)),
                  [&] { return describe(input); });
    });
    return found;
}

/// Units of roundoff by which eta may be off before a reflectance counts as wrong: those of its own rounding and of
/// 1 - eta² cos² θ_t.
constexpr Real index_units = 2.0L;

Measurement reflectance_absolute(const Setting& setting, const ::cl::Program& program) {
    Measurement found;
    evaluate(setting, program, all_angles(relative_indices()), [&](const auto& input, Real value, Real) {
        found.add(input.curve, static_cast<double>(reflectance_error(value, input.cosine, input.n(), index_units)),
                  [&] { return describe(input); });
    });
    return found;
}

Measurement reflectance_at_critical(const Setting& setting, const ::cl::Program& program) {
    std::vector<DielectricInput> inputs;
    for (const float eta : relative_indices()) {
        const std::vector<DielectricInput> more = around_critical(1.0F / eta);
        inputs.insert(inputs.end(), more.begin(), more.end());
    }
    Measurement found;
    evaluate(setting, program, inputs, [&](const auto& input, Real value, Real) {
        found.add(input.curve, static_cast<double>(reflectance_error(value, input.cosine, input.n(), index_units)),
                  [&] { return describe(input); });
    });
    return found;
}

Measurement reflectance_relative(const Setting& setting, const ::cl::Program& program) {
    std::vector<float> etas{1.0F};
    for (const float step : ratio_steps(1e-7, 0.1, 24)) {
        etas.push_back(1.0F + step);
        etas.push_back(1.0F - step);
    }
    std::vector<DielectricInput> inputs = all_angles(etas);
    for (DielectricInput& input : inputs)
        input.curve -= 1.0F;
    std::erase_if(inputs, [](const auto& input) { return input.inverse == 1.0F && input.cosine == 0.0F; });
    Measurement found;
    evaluate(setting, program, inputs, [&](const auto& input, Real value, Real) {
        const Real exact = reflectance(input.cosine, input.n());
        // Of the rounding of 1/eta the result knows nothing, so only what lies beyond the critical region counts.
        const bool is_critical = input.inverse > 1.0F && std::abs(input.cosine - critical_cosine(input.inverse)) < 1e-2;
        const Real error =
            is_critical ? reflectance_error(value, input.cosine, input.n(), index_units) : std::abs(value - exact);
        found.add(input.curve, static_cast<double>(error == 0.0L ? 0.0L : error / exact),
                  [&] { return describe(input); });
    });
    return found;
}

Measurement conductors(const Setting& setting, const ::cl::Program& program) {
    const auto steps = static_cast<int>(inputs(setting, 30, 5));
    std::vector<float> ks = ratio_steps(1e-4, 100.0, steps);
    ks.push_back(0.0F);
    std::vector<float> ns = ratio_steps(0.01, 10.0, steps);
    ns.push_back(1.0F);
    std::vector<cl_float4> in;
    for (const float k : ks)
        for (const float n : ns)
            for (const float cosine : cosines())
                in.push_back(float4_of(cosine, n, k));
    const std::vector<cl_float4> out = run(setting, program, "conductor", in, 1, 1);
    Measurement found;
    for (std::size_t i = 0; i < in.size(); ++i) {
        const Real cosine = in[i].s[0];
        const Complex n{in[i].s[1], in[i].s[2]};
        for (const Real value : {static_cast<Real>(out[i].s[0]), static_cast<Real>(out[i].s[1])})
            found.add(in[i].s[2], static_cast<double>(reflectance_error(value, cosine, n, index_units)), [&] {
                return fmt::format("cos = {:.9g}, n = {:.9g}, k = {:.9g}", in[i].s[0], in[i].s[1], in[i].s[2]);
            });
    }
    return found;
}

} // namespace

std::vector<Case> fresnel_cases(const Programs& cores) {
    const auto with = [&cores](Measurement (*measure)(const Setting&, const ::cl::Program&)) {
        return [cores, measure](const Setting& setting) { return measure(setting, cores(setting)); };
    };
    return {{"optics", "angle of refraction, eta 0.1 to 10", "eta", "cos² of refraction, absolute", 5e-7, 5e-7,
             with(cosine_squared)},
            {"optics", "entering at cosines of 1 to 1e-8", "cos", "cosine of refraction, relative", 5e-7, 5e-7,
             with(entering_cosine)},
            {"optics", "reflectance, eta 0.1 to 10", "eta", "beyond the roundings of eta, absolute", 2e-6, 2e-6,
             with(reflectance_absolute)},
            {"optics", "reflectance, eta 1 and 1 ± 1e-7 to 1 ± 0.1", "eta - 1", "beyond the roundings of eta, relative",
             2e-6, 2e-6, with(reflectance_relative)},
            {"optics", "reflectance, critical angle ± 1e-7 to 1e-2", "cos - critical cos",
             "beyond the roundings of eta, absolute", 5e-7, 5e-7, with(reflectance_at_critical)},
            {"optics", "conductors, n 0.01 to 10, k 0 to 100", "k", "beyond the roundings of n and k, absolute", 1e-6,
             1e-6, with(conductors)}};
}

} // namespace tristim::selftest
