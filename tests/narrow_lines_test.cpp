// Lines narrower than the bins of 1 nm: nothing of their energy is lost on the way from a table to the samplers.

#include "spectra/colour.h"
#include "wavelength_passes.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <limits>

namespace tristim {
namespace {

using namespace kernel_test;

constexpr const char* channel_names = "XYZ";

/// A triangle of unit area whose foot is `width_nm` wide.
Spectrum line(double at_nm, double width_nm) {
    return Spectrum::piecewise_linear({at_nm - 0.5 * width_nm, at_nm, at_nm + 0.5 * width_nm},
                                      {0.0, 2.0 / width_nm, 0.0});
}

double sum(const WavelengthBins& bins) {
    double total = 0.0;
    for (const double bin : bins)
        total += bin;
    return total;
}

/// Both feet of a line are known to a rounding of λ, so its area is to twice that, relative to the width.
double area_error(double at_nm, double width_nm) {
    return 2.0 * at_nm * std::numeric_limits<double>::epsilon() / width_nm;
}

TEST(NarrowLines, BinsHoldTheWholeLine) {
    for (const double width : {0.1, 0.01, 1e-3, 1e-6}) {
        for (const double at : {380.7, 404.6565, 546.075, 579.067, 779.3}) {
            const auto bins = line(at, width).bins();
            EXPECT_NEAR(bins[static_cast<std::size_t>(at - lambda_min_nm)], 1.0, area_error(at, width)) << at;
            EXPECT_NEAR(sum(bins), 1.0, area_error(at, width)) << at << ", " << width;
        }
    }
}

TEST(NarrowLines, LineOnABorderIsSharedByItsBins) {
    for (const double width : {0.01, 1e-6}) {
        const auto bins = line(546.0, width).bins();
        EXPECT_NEAR(bins[165], 0.5, area_error(546.0, width));
        EXPECT_NEAR(bins[166], 0.5, area_error(546.0, width));
        EXPECT_NEAR(sum(bins), 1.0, area_error(546.0, width));
    }
    // A border at a quarter of the foot cuts off a triangle of half the height and half the half width: 1/8.
    const auto bins = line(546.0025, 0.01).bins();
    EXPECT_NEAR(bins[165], 0.125, area_error(546.0, 0.01));
    EXPECT_NEAR(bins[166], 0.875, area_error(546.0, 0.01));
}

TEST(NarrowLines, SeveralLinesInOneBinAddUp) {
    // Areas 1, 2 and 4 of lines 0.01 nm wide, one so near the next that their feet touch.
    const Spectrum lines =
        Spectrum::piecewise_linear({577.095, 577.1, 577.105, 577.5, 577.505, 577.51, 577.515, 577.52},
                                   {0.0, 200.0, 0.0, 0.0, 400.0, 0.0, 800.0, 0.0});
    EXPECT_NEAR(lines.bins()[197], 7.0, 7.0 * area_error(577.0, 0.01));
    EXPECT_NEAR(sum(lines.bins()), 7.0, 7.0 * area_error(577.0, 0.01));
}

/// x̄, ȳ and z̄ are linear between whole nanometres, so a symmetric line inside a bin has XYZ = f(its centre) / k
/// exactly; the bins have the mean of f at the bin's two ends instead.
TEST(NarrowLines, TristimulusValuesAreExactButForTheBinsMeanOfTheMatchingFunctions) {
    const char* functions[] = {"cie-x", "cie-y", "cie-z"};
    for (const double at : {404.6565, 435.8335, 546.075, 576.961, 579.067, 589.5924}) {
        const Xyz xyz = spectrum_to_xyz(line(at, 0.01));
        for (std::size_t c = 0; c < 3; ++c) {
            const Spectrum f = Spectrum::named(functions[c]);
            const double rounding = area_error(at, 0.01) * xyz[c];
            const double half_rise = 0.5 * std::abs(f(std::ceil(at)) - f(std::floor(at)));
            EXPECT_NEAR(xyz[c], f(at) / cie_y_integral(), half_rise / cie_y_integral() + rounding)
                << channel_names[c] << " at " << at;
        }
    }
}

/// Σ_w c_w E(λ_w) of a light in one pass after the other, from kernels/wavelengths.cl.
class LitPasses {
  public:
    LitPasses(const std::string& method, bool random_sequence, const Spectrum& light)
        : passes_(parse_method(method), random_sequence, {{light, Passes::Use::Emission}}) {}

    Xyz operator()(std::uint32_t pass) {
        passes_(pass);
        Xyz xyz{};
        for (int w = 0; w < passes_.w(); ++w) {
            for (std::size_t c = 0; c < 3; ++c)
                xyz[c] += passes_.weight(c, w) * passes_.spectrum(0, w);
        }
        return xyz;
    }

  private:
    Passes passes_;
};

/// Float weights and emission, a rounding each, and their products summed in double.
constexpr double rounding = 4.0 * kernel_test::unit_roundoff;

std::vector<std::pair<std::string, Spectrum>> lights() {
    return {{"the measured mercury lamp", Spectrum::named("illum-mercury")},
            {"the mercury lines", Spectrum::named("illum-mercury-lines")},
            {"a line of 0.01 nm", line(546.075, 0.01)},
            {"a line of 0.01 nm between two bins", line(560.0, 0.01)}};
}

/// Each pass of the spectral method takes every bin with its whole energy.
TEST(NarrowLines, EverySpectralPassHasTheTristimulusValues) {
    for (const auto& [name, light] : lights()) {
        const Xyz expected = spectrum_to_xyz(light);
        LitPasses passes("spectral:400", false, light);
        for (const std::uint32_t pass : {0U, 1U, 2U, 1000U, 0xffffffffU}) {
            const Xyz xyz = passes(pass);
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(xyz[c], expected[c], rounding * expected[c]) << name << ", " << channel_names[c];
        }
    }
}

TEST(NarrowLines, RandomTristimulusPassesConvergeToTheTristimulusValues) {
    constexpr std::uint32_t pass_count = 5000;
    for (const auto& [name, light] : lights()) {
        const Xyz expected = spectrum_to_xyz(light);
        LitPasses passes("tristimulus:1", true, light);
        std::array<Moments, 3> moments;
        for (std::uint32_t pass = 0; pass < pass_count; ++pass) {
            const Xyz xyz = passes(pass);
            for (std::size_t c = 0; c < 3; ++c)
                moments[c].add(xyz[c]);
        }
        for (std::size_t c = 0; c < 3; ++c) {
            // A channel that hardly sees the line has too few hits for a normal distribution.
            const double hits = pass_count * expected[c] / spectrum_to_xyz(Spectrum::constant(1.0))[c];
            if (hits < 30.0)
                continue;
            expect_mean(fmt::format("{}, {}", name, channel_names[c]), moments[c].mean(), expected[c],
                        moments[c].standard_error(), rounding * expected[c]);
        }
    }
}

/// By default u goes through a Sobol' sequence with a digital shift: of n = 2^m passes each interval [k/n, (k + 1)/n)
/// has one. So the number of passes with u below any x is n x up to 1, and 1 more for a point so near x that rounding
/// to float decides. By Koksma's inequality the mean errs by no more than 2/n times the variation of the bins.
TEST(NarrowLines, StratifiedPassesConvergeByTheirDiscrepancy) {
    constexpr std::uint32_t passes_rendered = 16384;
    const Xyz white = spectrum_to_xyz(Spectrum::constant(1.0));
    for (const auto& [name, light] : lights()) {
        const Xyz expected = spectrum_to_xyz(light);
        const auto bins = light.bins();
        double variation = 0.0;
        for (std::size_t i = 1; i < bins.size(); ++i)
            variation += std::abs(bins[i] - bins[i - 1]);
        LitPasses passes("tristimulus:1", false, light);
        Xyz mean{};
        for (std::uint32_t pass = 0; pass < passes_rendered; ++pass) {
            const Xyz xyz = passes(pass);
            for (std::size_t c = 0; c < 3; ++c)
                mean[c] += xyz[c] / passes_rendered;
        }
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(mean[c], expected[c], white[c] * 2.0 / passes_rendered * variation + rounding * expected[c])
                << name << ", " << channel_names[c];
    }
}

} // namespace
} // namespace tristim
