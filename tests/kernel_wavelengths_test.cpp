// kernels/wavelengths.cl: the weights and spectra of a pass, and what their averages over the passes converge to.

#include "spectra/colour.h"
#include "wavelength_passes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

namespace tristim::wavelength_tables_test {
namespace {

using namespace kernel_test;
using Use = SpectrumTable::Use;

constexpr const char* channel_names = "XYZ";

/// A line of 0.1 nm and unit radiance.
Spectrum line(double at_nm) {
    return Spectrum::piecewise_linear({at_nm - 0.1, at_nm - 0.05, at_nm, at_nm + 0.05}, {0.0, 10.0, 10.0, 0.0});
}

/// Of the methods that integrate a constant exactly in every pass.
TEST(KernelWavelengths, WeightsSumToTheIntegrals) {
    for (const std::string name : {"tristimulus:1", "tristimulus:2", "tristimulus:5", "tristimulus:20", "spectral:400",
                                   "rgb", "gauss:4", "gauss:5", "gauss:6", "gauss:7"}) {
        for (const bool random_sequence : {false, true}) {
            Passes passes(parse_method(name), random_sequence, {{bumpy(), Use::Reflectance}});
            for (const std::uint32_t pass : {0U, 1U, 12345U, 0xffffffffU}) {
                passes(pass);
                for (std::size_t channel = 0; channel < 3; ++channel) {
                    double sum = 0.0, magnitude = 0.0;
                    for (int slot = 0; slot < passes.w(); ++slot) {
                        sum += passes.weight(channel, slot);
                        magnitude += std::abs(passes.weight(channel, slot));
                    }
                    double expected = 0.0; // of a constant spectrum; for rgb, of RGB (1, 1, 1)
                    for (const double bin : cie_bins()[channel])
                        expected += bin / cie_y_integral();
                    if (name == "rgb")
                        expected = rgb_to_xyz({1.0, 1.0, 1.0})[channel];
                    // Each weight is rounded once or twice.
                    EXPECT_NEAR(sum, expected, 4.0 * unit_roundoff * magnitude)
                        << name << ", " << channel_names[channel];
                }
            }
        }
    }
}

TEST(KernelWavelengths, PaddingWeighsNothing) {
    for (const MethodKind& kind : method_kinds()) {
        for (const int count : {1, 5, 6}) { // none of which fills its vectors, if the method has it
            const Method method{kind.kind, std::clamp(count, kind.least, kind.most)};
            Passes passes(method, false, {{bumpy(), Use::Reflectance}, {bumpy(), Use::Emission}});
            for (const std::uint32_t pass : {0U, 12345U}) {
                passes(pass);
                for (int slot = passes.w(); slot < passes.padded(); ++slot) {
                    const std::string where = fmt::format("{}, padding {}", method.name(), slot);
                    // A refractive index of zero would be divided by.
                    EXPECT_EQ(passes.lambda(slot), passes.lambda(passes.w() - 1)) << where;
                    EXPECT_EQ(passes.spectrum(0, slot), passes.spectrum(0, passes.w() - 1)) << where;
                    EXPECT_EQ(passes.spectrum(1, slot), 0.0) << where << ", emission";
                    for (std::size_t channel = 0; channel < 3; ++channel)
                        EXPECT_EQ(passes.weight(channel, slot), 0.0) << where;
                }
            }
        }
    }
}

/// How far a line between two neighbouring bin means may be off the curve: such a line is an average of the curve over
/// the 1.5 nm on either side of λ that leaves straight lines alone, so it is off by no more than the curve is off a
/// line. (Sampled; twice that. λ is rounded to 2^-15 nm.)
double off_the_curve(const Spectrum& spectrum, double lambda) {
    const double slope = (spectrum(lambda + 1.5) - spectrum(lambda - 1.5)) / 3.0;
    double largest = 0.0;
    for (double step = -1.5; step <= 1.5; step += 0.125)
        largest = std::max(largest, std::abs(spectrum(lambda + step) - spectrum(lambda) - slope * step));
    return 2.0 * largest + 0x1p-15 * std::abs(slope);
}

/// Bin means as they are for emission; smooth data as a line between the means at the bins' centres.
TEST(KernelWavelengths, SpectraAtTheWavelengthsOfAPass) {
    const Spectrum white = Spectrum::named("stdillum-F11"), glass = Spectrum::named("glass-F11");
    for (const std::string name : {"tristimulus:20", "spectral:400"}) {
        Passes passes(parse_method(name), true,
                      {{white, Use::Emission}, {bumpy(), Use::Reflectance}, {glass, Use::Index}});
        const auto white_bins = white.bins();
        for (std::uint32_t pass = 0; pass < 50; ++pass) {
            passes(pass);
            for (int slot = 0; slot < passes.w(); ++slot) {
                const double lambda = passes.lambda(slot);
                ASSERT_GE(lambda, lambda_min_nm);
                ASSERT_LE(lambda, lambda_max_nm);
                const auto bin = static_cast<std::size_t>(std::min(lambda - lambda_min_nm, lambda_bins - 1.0));
                // The kernel reads the bin before λ was rounded; on a border either may be meant.
                const double border = std::abs(lambda - std::round(lambda));
                if (border > 1e-4) {
                    EXPECT_NEAR(passes.spectrum(0, slot), white_bins[bin], unit_roundoff * white_bins[bin])
                        << name << ", λ = " << lambda;
                }
                if (lambda < 381.5 || lambda > 778.5)
                    continue; // the outermost means hold to the ends
                int row = 1;
                for (const Spectrum& spectrum : {bumpy(), glass}) {
                    const double value = passes.spectrum(row++, slot);
                    EXPECT_NEAR(value, spectrum(lambda), off_the_curve(spectrum, lambda) + 4.0 * unit_roundoff * value)
                        << name << ", spectrum " << row - 1 << ", λ = " << lambda;
                }
            }
        }
    }
}

/// Mean over the passes of Σ c_w L(λ_w) R(λ_w) and of Σ c_w L(λ_w).
struct Averages {
    std::array<Moments, 3> reflected, lit;
};

Averages average(const std::string& method, bool random_sequence, const Spectrum& light, std::uint32_t count) {
    Passes passes(parse_method(method), random_sequence, {{light, Use::Emission}, {bumpy(), Use::Reflectance}});
    Averages averages;
    for (std::uint32_t pass = 0; pass < count; ++pass) {
        passes(pass);
        for (std::size_t channel = 0; channel < 3; ++channel) {
            double reflected = 0.0, lit = 0.0;
            for (int slot = 0; slot < passes.w(); ++slot) {
                const double radiance = passes.weight(channel, slot) * passes.spectrum(0, slot);
                lit += radiance;
                reflected += radiance * passes.spectrum(1, slot);
            }
            averages.lit[channel].add(lit);
            averages.reflected[channel].add(reflected);
        }
    }
    return averages;
}

/// (1/k) ∫ L R f dλ, with L and f of the bins and R the kernel's line between bin means, in 200 steps a bin.
Xyz reflected_xyz(const Spectrum& light, const Spectrum& reflectance) {
    const auto light_bins = light.bins(), means = reflectance.bins();
    Xyz xyz{};
    for (std::size_t i = 0; i < light_bins.size(); ++i) {
        double mean = 0.0;
        constexpr int steps = 200;
        for (int step = 0; step < steps; ++step) {
            const double x = std::clamp(static_cast<double>(i) + (step + 0.5) / steps - 0.5, 0.0, lambda_bins - 1.0);
            const auto left = std::min(static_cast<std::size_t>(x), static_cast<std::size_t>(lambda_bins - 2));
            const double t = x - static_cast<double>(left);
            mean += ((1.0 - t) * means[left] + t * means[left + 1]) / steps;
        }
        for (std::size_t channel = 0; channel < 3; ++channel)
            xyz[channel] += light_bins[i] * mean * cie_bins()[channel][i] / cie_y_integral();
    }
    return xyz;
}

/// Float weights and spectra: a few units for each product; sums of positive numbers.
constexpr double rounding = 16.0 * unit_roundoff;

TEST(KernelWavelengths, RandomPassesConvergeToTheIntegral) {
    const Spectrum white = Spectrum::named("stdillum-D65");
    const Xyz expected = reflected_xyz(white, bumpy()), light = spectrum_to_xyz(white);
    for (const std::string method : {"tristimulus:1", "tristimulus:5", "spectral:400"}) {
        const Averages averages = average(method, true, white, 3000);
        for (std::size_t c = 0; c < 3; ++c) {
            expect_mean(fmt::format("{}, {} of D65 reflected", method, channel_names[c]), averages.reflected[c].mean(),
                        expected[c], averages.reflected[c].standard_error(), rounding * expected[c]);
            expect_mean(fmt::format("{}, {} of D65", method, channel_names[c]), averages.lit[c].mean(), light[c],
                        averages.lit[c].standard_error(), rounding * light[c]);
        }
    }
}

/// By Koksma's inequality the error is at most the discrepancy over the passes times the variation of the integrand
/// over C(λ), which is that of L R over λ.
TEST(KernelWavelengths, StratifiedPassesConvergeByTheirDiscrepancy) {
    const Spectrum white = Spectrum::named("stdillum-D65");
    const Xyz expected = reflected_xyz(white, bumpy()), light = spectrum_to_xyz(white);
    constexpr std::uint32_t count = 3000;
    double variation = 0.0, reflected_variation = 0.0;
    const auto bins = white.bins(), means = bumpy().bins();
    for (std::size_t i = 1; i < bins.size(); ++i) {
        variation += std::abs(bins[i] - bins[i - 1]);
        reflected_variation +=
            std::abs(bins[i] * means[i] - bins[i - 1] * means[i - 1]) + std::abs(bins[i] - bins[i - 1]);
    }
    // See KernelWavelengthSequences.StratifiedSequenceFillsEverySet; a point more for those that rounding moves.
    const double discrepancy = (std::popcount(count) + 1.0) / count;
    for (const int sets : {1, 5}) {
        const std::string method = fmt::format("tristimulus:{}", sets);
        const Averages averages = average(method, false, white, count);
        for (std::size_t c = 0; c < 3; ++c) {
            double share = 0.0; // ∫f/k
            for (const double bin : cie_bins()[c])
                share += bin / cie_y_integral();
            const double bound = share * discrepancy / sets;
            EXPECT_NEAR(averages.reflected[c].mean(), expected[c], bound * reflected_variation + rounding * expected[c])
                << method << ", " << channel_names[c];
            EXPECT_NEAR(averages.lit[c].mean(), light[c], bound * variation + rounding * light[c])
                << method << ", " << channel_names[c];
        }
    }
}

TEST(KernelWavelengths, RgbReproducesTheXyzOfEmissionInGamut) {
    for (const std::string name : {"stdillum-D65", "stdillum-A", "stdillum-F11"}) {
        const Spectrum light = Spectrum::named(name);
        const Xyz expected = spectrum_to_xyz(light);
        const Averages averages = average("rgb", false, light, 2);
        for (std::size_t c = 0; c < 3; ++c) {
            // The rows of the matrix times RGB up to 2, rounded to float each.
            EXPECT_NEAR(averages.lit[c].mean(), expected[c], 32.0 * unit_roundoff) << name << ", " << channel_names[c];
        }
    }
}

/// A line of 0.1 nm keeps its energy, whichever bin it lies in and though no sample ever meets it exactly. Alone in the
/// dark for the spectral methods; for rgb beside a white light, since a line's own colour lies outside of sRGB.
TEST(KernelWavelengths, NarrowLinesKeepTheirEnergy) {
    for (const double at : {435.83, 546.07, 611.98}) {
        const Spectrum light = line(at);
        const Xyz expected = spectrum_to_xyz(light);
        const auto bin = static_cast<std::size_t>(at - 380.0);
        for (std::size_t c = 0; c < 3; ++c) {
            // Area 1 (0.05·10 + 2·½·0.05·10), times f of its two bins at most.
            const double low = std::min({cie_bins()[c][bin - 1], cie_bins()[c][bin], cie_bins()[c][bin + 1]});
            const double high = std::max({cie_bins()[c][bin - 1], cie_bins()[c][bin], cie_bins()[c][bin + 1]});
            ASSERT_GE(expected[c], 0.999999 * low / cie_y_integral());
            ASSERT_LE(expected[c], 1.000001 * high / cie_y_integral());
        }
        for (const std::string method : {"tristimulus:1", "tristimulus:20", "spectral:400"}) {
            const int sets = parse_method(method).count;
            const std::uint32_t passes = sets == 1 ? 8000 : 800;
            const Averages averages = average(method, true, light, passes);
            for (std::size_t c = 0; c < 3; ++c) {
                // A channel that hardly sees the line has too few hits for a normal distribution.
                const double hits = passes * sets * expected[c] / spectrum_to_xyz(Spectrum::constant(1.0))[c];
                if (hits < 30.0 && method != "spectral:400")
                    continue;
                expect_mean(fmt::format("{}, {} of a line at {} nm", method, channel_names[c], at),
                            averages.lit[c].mean(), expected[c], averages.lit[c].standard_error(),
                            rounding * expected[c]);
            }
        }
        std::vector<double> lambda, values;
        for (const auto& [x, y] : {std::array{380.0, 0.05},
                                   {at - 0.1, 0.05},
                                   {at - 0.05, 10.05},
                                   {at, 10.05},
                                   {at + 0.05, 0.05},
                                   {780.0, 0.05}}) {
            lambda.push_back(x);
            values.push_back(y);
        }
        const Spectrum beside_white = Spectrum::piecewise_linear(lambda, values);
        const Averages averages = average("rgb", false, beside_white, 2);
        const Xyz both = spectrum_to_xyz(beside_white);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(averages.lit[c].mean(), both[c], 32.0 * unit_roundoff)
                << "rgb, " << channel_names[c] << ", line at " << at;
    }
}

} // namespace
} // namespace tristim::wavelength_tables_test
