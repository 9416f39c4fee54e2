// kernels/samplers/: what the passes of every sampler average to, and what single passes promise.

#include "sampler_oracle.h"
#include "wavelength_passes.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

namespace tristim {
namespace {

using namespace kernel_test;

const std::vector<std::string> lights{"illum-mercury", "stdillum-F12", "stdillum-D65"};

/// Sums over the wavelengths of a pass for the channels: of the weights c, of c L, and of c L R.
struct PassSums {
    Xyz weights{}, lit{}, reflected{};
};

std::vector<PassSums> pass_sums(const SamplerCase& of, bool random_sequence, std::size_t passes,
                                const Spectrum& light) {
    const std::vector<WavelengthSample> samples =
        draw_samples({of.method, random_sequence, of.emission}, 11, passes, light, bumpy());
    std::vector<PassSums> sums(passes);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        PassSums& pass = sums[i / static_cast<std::size_t>(of.method.wavelengths())];
        for (std::size_t c = 0; c < 3; ++c) {
            const double weight = samples[i].weight(c), radiance = weight * samples[i].light;
            pass.weights[c] += weight;
            pass.lit[c] += radiance;
            pass.reflected[c] += radiance * samples[i].reflectance;
        }
    }
    return sums;
}

/// One of the three sums: what it is called, where to find it, and its integral.
struct Quantity {
    std::string name;
    Xyz PassSums::*sum;
    std::array<SamplerOracle::Integral, 3> integrals;
    double rounding; ///< of the sum, relative
};

std::array<Quantity, 3> quantities(const SamplerCase& of, const std::string& light) {
    const SamplerOracle oracle(of.method, of.emission);
    WavelengthBins ones{};
    ones.fill(1.0);
    const WavelengthBins radiance = Spectrum::named(light).bins(), reflectance = bumpy().bins();
    // A few roundings of each product; λ itself is rounded by 2^-15 nm and kept 2^-14 nm away from the next bin.
    constexpr double products = 16.0 * unit_roundoff;
    std::array<Quantity, 3> result{Quantity{of.name + ", weights", &PassSums::weights, {}, products},
                                   Quantity{of.name + ", " + light, &PassSums::lit, {}, products},
                                   Quantity{of.name + ", " + light + " reflected", &PassSums::reflected, {}, products}};
    for (std::size_t c = 0; c < 3; ++c) {
        result[0].integrals[c] = oracle.integral(c, ones, ones);
        result[1].integrals[c] = oracle.integral(c, radiance, ones);
        result[2].integrals[c] = oracle.integral(c, radiance, reflectance);
    }
    constexpr double least_reflectance = 0.1;
    result[2].rounding += bumpy_slope * (0x1p-15 + 0x1p-14) / least_reflectance;
    return result;
}

/// Random passes by their standard error.
void expect_random_means(const SamplerCase& of, const std::string& light) {
    const std::size_t passes = of.method.wavelengths() > 100 ? 1 << 9 : 1 << 16;
    const std::vector<PassSums> sums = pass_sums(of, true, passes, Spectrum::named(light));
    for (const Quantity& quantity : quantities(of, light)) {
        for (std::size_t c = 0; c < 3; ++c) {
            Moments moments;
            for (const PassSums& pass : sums)
                moments.add((pass.*quantity.sum)[c]);
            const SamplerOracle::Integral& exact = quantity.integrals[c];
            expect_mean(fmt::format("{}, {}", quantity.name, "XYZ"[c]), moments.mean(), exact.value,
                        moments.standard_error(), exact.rounding + quantity.rounding * exact.value);
        }
    }
}

/// 2^m stratified passes, by Koksma's inequality: the mean is off by no more than 2/2^m
/// (NarrowLines.StratifiedPassesConvergeByTheirDiscrepancy) times the variation of the integrand over positions.
constexpr std::size_t stratified_passes = 8192;
void expect_stratified_means(const SamplerCase& of, const std::string& light) {
    const std::vector<PassSums> sums = pass_sums(of, false, stratified_passes, Spectrum::named(light));
    for (const Quantity& quantity : quantities(of, light)) {
        for (std::size_t c = 0; c < 3; ++c) {
            double mean = 0.0;
            for (const PassSums& pass : sums)
                mean += (pass.*quantity.sum)[c] / stratified_passes;
            const SamplerOracle::Integral& exact = quantity.integrals[c];
            EXPECT_NEAR(mean, exact.value,
                        2.0 / stratified_passes / SamplerOracle(of.method, of.emission).parts() * exact.variation +
                            exact.rounding + quantity.rounding * exact.value)
                << quantity.name << ", "
                << "XYZ"[c];
        }
    }
}

/// The cases with each light: samplers that heed a light with theirs, the others with all.
template <typename Function>
void for_each_light(const std::vector<int>& counts, Function&& function) {
    for (const std::string& light : lights) {
        for (const SamplerCase& of : sampler_cases(counts, {light}))
            function(of, light);
    }
}

TEST(KernelSamplerMeans, RandomPassesAverageToTheIntegrals) {
    for_each_light({4}, expect_random_means);
}

TEST(KernelSamplerMeans, StratifiedPassesAverageToTheIntegrals) {
    for_each_light({1, 4, 16}, expect_stratified_means);
}

/// The samplers that heed the light, told of one that is not in the scene.
std::vector<SamplerCase> misled_cases(int count) {
    std::vector<SamplerCase> cases;
    for (const MethodKind& kind : method_kinds()) {
        const Method method{kind.kind, count};
        if (heeds_light(kind.kind))
            cases.push_back(
                {fmt::format("{} for sodium", method.name()), method, Spectrum::named("illum-sodium-lines").bins()});
    }
    return cases;
}

TEST(KernelSamplerMeans, OtherLightThanTheSamplersAveragesToTheIntegrals) {
    for (const std::string light : {"stdillum-D65", "illum-mercury-lines"}) {
        for (const SamplerCase& of : misled_cases(4)) {
            expect_random_means(of, light);
            expect_stratified_means(of, light);
        }
    }
}

/// Wherever the scene's light is none of the sampler's, weights stay within 1/defensive_share of the plain sampler's:
/// ∫f/(k N) in sets of three, (x̄, ȳ, z̄)/(x̄ + ȳ + z̄) · ∫(x̄ + ȳ + z̄)/(k C) where all channels share a wavelength.
TEST(KernelSamplerMeans, WeightsStayBoundedWhereTheLightEmitsNothing) {
    for (const SamplerCase& of : misled_cases(4)) {
        const bool sets = of.method.kind == Method::Kind::Illuminant;
        const SamplerOracle oracle(of.method, of.emission);
        const SamplerOracle plain({sets ? Method::Kind::Tristimulus : Method::Kind::Mixture, of.method.count}, {});
        const std::vector<WavelengthSample> samples =
            draw_samples({of.method, true, of.emission}, 3, 1 << 14, Spectrum::constant(1.0), Spectrum::constant(1.0));
        double highest = 0.0;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const int slot = static_cast<int>(i) % of.method.wavelengths();
            const double lambda = samples[i].lambda;
            const Xyz bound = plain.weight(slot, lambda);
            for (std::size_t c = 0; c < 3; ++c) {
                const double limit = bound[c] / defensive_share;
                ASSERT_LE(samples[i].weight(c), limit * (1.0 + oracle.weight_error(oracle.row(slot), lambda)))
                    << of.name << ", "
                    << "XYZ"[c] << " at " << lambda << " nm";
                if (limit > 0.0)
                    highest = std::max(highest, samples[i].weight(c) / limit);
            }
        }
        EXPECT_GT(highest, 0.9) << of.name << ": the bound was never put to the test";
    }
}

/// mixture: X + Y + Z of a constant spectrum is the same in every pass.
TEST(KernelSamplerMeans, MixturePassesAgreeOnXPlusYPlusZOfAConstant) {
    const Xyz white = spectrum_to_xyz(Spectrum::constant(1.0));
    const double expected = white[0] + white[1] + white[2];
    for (const int count : {1, 4, 16}) {
        const SamplerCase of{"mixture", {Method::Kind::Mixture, count}, {}};
        const SamplerOracle oracle(of.method, {});
        for (const bool random_sequence : {false, true}) {
            const std::vector<WavelengthSample> samples =
                draw_samples({of.method, random_sequence, {}}, 2, 1000, Spectrum::constant(1.0), bumpy());
            const auto w = static_cast<std::size_t>(count);
            for (std::size_t pass = 0; pass < 1000; ++pass) {
                double sum = 0.0, tolerance = 0.0;
                for (std::size_t i = pass * w; i < (pass + 1) * w; ++i) {
                    sum += samples[i].weight(0) + samples[i].weight(1) + samples[i].weight(2);
                    tolerance += expected / count * oracle.weight_error(0, samples[i].lambda);
                }
                ASSERT_NEAR(sum, expected, tolerance) << count << " wavelengths, pass " << pass;
            }
        }
    }
}

/// The share that the samplers keep for wavelengths without light makes a pass of the light alone vary, but p is at
/// least 1 - defensive_share times the pdf that would make it exact. So no wavelength, nor a pass, sees more than
/// 1/(1 - defensive_share) of the light's X, Y and Z (of their sum where channels share wavelengths) for its part.
TEST(KernelSamplerMeans, WavelengthsOfTheSamplersLightAreBounded) {
    for_each_light({1, 4}, [](const SamplerCase& of, const std::string& light) {
        if (!heeds_light(of.method.kind))
            return;
        const bool sets = of.method.kind == Method::Kind::Illuminant;
        const SamplerOracle oracle(of.method, of.emission);
        const Xyz exact = spectrum_to_xyz(Spectrum::named(light));
        const std::vector<WavelengthSample> samples =
            draw_samples({of.method, true, of.emission}, 7, 2000, Spectrum::named(light), bumpy());
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const std::size_t row = oracle.row(static_cast<int>(i) % of.method.wavelengths());
            double seen = 0.0, whole = 0.0;
            for (std::size_t c = 0; c < 3; ++c) {
                seen += samples[i].weight(c) * samples[i].light;
                whole += !sets || c == row ? exact[c] : 0.0;
            }
            const double rounding = oracle.weight_error(row, samples[i].lambda) + 2.0 * unit_roundoff;
            ASSERT_LE(seen, whole / oracle.parts() / (1.0 - defensive_share) * (1.0 + rounding))
                << of.name << ", row " << row << " at " << samples[i].lambda << " nm";
        }
    });
}

/// Methods with fixed wavelengths have the same error in every pass: on a lamp of lines, more than a hundredth of Y,
/// where rounding explains 1e-6. All others have none that the bounds above do not explain.
TEST(KernelSamplerMeans, BiasedMethodsAreThoseThatSaySo) {
    const Spectrum light = Spectrum::named("illum-mercury-lines");
    const SamplerOracle any(parse_method("uniform:1"), {});
    for (const MethodKind& kind : method_kinds()) {
        for (const int count : {kind.least, std::clamp(4, kind.least, kind.most)}) {
            const Method method{kind.kind, count};
            if (method.unbiased()) {
                expect_stratified_means({method.name(), method, light.bins()}, "illum-mercury-lines");
                continue;
            }
            Passes passes(method, true, light.bins(),
                          {{light, Passes::Use::Emission}, {bumpy(), Passes::Use::Reflectance}});
            Xyz first{};
            double largest = 0.0;
            for (const std::uint32_t pass : {0U, 1U, 1000U}) {
                passes(pass);
                Xyz xyz{};
                double magnitude = 0.0;
                for (std::size_t c = 0; c < 3; ++c) {
                    for (int slot = 0; slot < passes.w(); ++slot) {
                        const double term =
                            passes.weight(c, slot) * passes.spectrum(0, slot) * passes.spectrum(1, slot);
                        xyz[c] += term;
                        magnitude += std::abs(term);
                    }
                    const double exact = any.integral(c, light.bins(), bumpy().bins()).value;
                    largest = std::max(largest, std::abs(xyz[c] - exact));
                }
                if (pass == 0)
                    first = xyz;
                EXPECT_EQ(xyz, first) << method.name() << ": fixed wavelengths vary between passes";
                EXPECT_GT(largest, 0.01) << method.name() << " says that it is biased";
                EXPECT_GT(largest, 1000.0 * 16.0 * unit_roundoff * magnitude) << method.name();
            }
        }
    }
}

} // namespace
} // namespace tristim
