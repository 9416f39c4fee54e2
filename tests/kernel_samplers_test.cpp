// kernels/samplers/: where every sampler puts its wavelengths and what it lets them weigh, against the formulas in
// double.

#include "sampler_oracle.h"
#include "spectra/gauss_rule.h"
#include "wavelength_passes.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

namespace tristim {
namespace {

using namespace kernel_test;

const std::vector<int> counts{1, 4, 16};
/// Lines and nothing between them, phosphors, and daylight.
const std::vector<std::string> emissions{"illum-mercury-lines", "stdillum-F12", "stdillum-D65"};

/// The samples of a case, of which neither light nor reflectance matters.
std::vector<WavelengthSample> samples_of(const SamplerCase& of, bool random_sequence, std::size_t passes) {
    return draw_samples({of.method, random_sequence, of.emission}, 5, passes, Spectrum::constant(1.0),
                        Spectrum::constant(1.0));
}

/// Cells of half a nanometre; their number has no divisor in common with those of bins and parts, whose borders,
/// where rounding decides, thus lie within cells.
constexpr std::size_t cells = 797;
double cell_border(std::size_t cell) {
    return lambda_min_nm + lambda_bins * static_cast<double>(cell) / cells;
}

/// Samples drawn one by one, each row's in one histogram: were they alike within a pass, χ² would grow by their number.
void expect_distribution(const SamplerCase& of, const SamplerOracle& oracle,
                         const std::vector<WavelengthSample>& samples) {
    const auto w = static_cast<std::size_t>(of.method.wavelengths());
    for (std::size_t row = 0; row < oracle.rows(); ++row) {
        Histogram histogram(cells);
        for (std::size_t i = row; i < samples.size(); i += oracle.rows()) {
            ASSERT_EQ(oracle.row(static_cast<int>(i % w)), row);
            histogram.add(Histogram::bin((samples[i].lambda - lambda_min_nm) / lambda_bins, cells));
        }
        std::vector<double> expected;
        for (std::size_t cell = 0; cell < cells; ++cell)
            expected.push_back(oracle.cdf(row, cell_border(cell + 1)) - oracle.cdf(row, cell_border(cell)));
        histogram.expect_distribution(fmt::format("{}, wavelengths of row {}", of.name, row), expected);
    }
}

/// A random first wavelength, evenly over the first of C equal parts of the CDF; the others at the same place in
/// theirs.
void expect_rotations(const SamplerCase& of, const SamplerOracle& oracle,
                      const std::vector<WavelengthSample>& samples) {
    constexpr std::size_t places = 251;
    const int parts = oracle.parts();
    Histogram histogram(places);
    double first = 0.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const int part = static_cast<int>(i) % parts;
        const double position = oracle.cdf(0, samples[i].lambda);
        if (part == 0) {
            first = position;
            histogram.add(Histogram::bin(position * parts, places));
        }
        // Besides the CDF's own errors, part + v is rounded and divided.
        ASSERT_NEAR(position, first + static_cast<double>(part) / parts,
                    oracle.cdf_error(0, samples[i].lambda) + oracle.cdf_error(0, lambda_min_nm) + 2.0 * unit_roundoff)
            << of.name << ", wavelength " << part;
    }
    histogram.expect_uniform(of.name + ", places in the first part");
}

TEST(KernelSamplers, RandomWavelengthsFollowThePdf) {
    constexpr std::size_t samples = 1 << 17;
    for (const SamplerCase& of : sampler_cases(counts, emissions)) {
        const SamplerOracle oracle(of.method, of.emission);
        const auto parts = static_cast<std::size_t>(oracle.parts());
        const auto drawn = samples_of(of, true, oracle.rotated() ? std::size_t{1} << 13 : samples / parts);
        if (oracle.rotated())
            expect_rotations(of, oracle, drawn);
        else
            expect_distribution(of, oracle, drawn);
    }
}

/// Over n = 2^m passes the stratified sequence has at any place between n x - 2 and n x + 2 of its points below x
/// (NarrowLines.StratifiedPassesConvergeByTheirDiscrepancy). So has each part of the CDF, at the borders of all cells.
TEST(KernelSamplers, StratifiedWavelengthsFollowThePdfByTheirDiscrepancy) {
    constexpr std::size_t passes = 8192;
    for (const SamplerCase& of : sampler_cases(counts, emissions)) {
        const SamplerOracle oracle(of.method, of.emission);
        const std::vector<WavelengthSample> samples = samples_of(of, false, passes);
        const int w = of.method.wavelengths(), parts = oracle.parts();
        double worst = 0.0;
        for (int slot = 0; slot < w; slot += std::max(1, w / 50)) {
            std::vector<double> lambdas;
            for (std::size_t pass = 0; pass < passes; ++pass)
                lambdas.push_back(samples[pass * static_cast<std::size_t>(w) + static_cast<std::size_t>(slot)].lambda);
            std::sort(lambdas.begin(), lambdas.end());
            const std::size_t row = oracle.row(slot);
            for (std::size_t cell = 0; cell <= cells; ++cell) {
                const double border = cell_border(cell);
                const double below =
                    static_cast<double>(std::lower_bound(lambdas.begin(), lambdas.end(), border) - lambdas.begin());
                const double expected = std::clamp(oracle.cdf(row, border) * parts - oracle.part(slot), 0.0, 1.0);
                const double tolerance = 2.0 / passes + parts * oracle.cdf_error(row, border);
                worst = std::max(worst, std::abs(below / passes - expected) / tolerance);
            }
        }
        EXPECT_LE(worst, 1.0) << of.name << ": off by that much of the bound";
    }
}

TEST(KernelSamplers, WeightsAreMatchingFunctionsOverThePdf) {
    for (const bool random_sequence : {false, true}) {
        for (const SamplerCase& of : sampler_cases(counts, emissions)) {
            const SamplerOracle oracle(of.method, of.emission);
            const std::vector<WavelengthSample> samples = samples_of(of, random_sequence, 500);
            for (std::size_t i = 0; i < samples.size(); ++i) {
                const int slot = static_cast<int>(i) % of.method.wavelengths();
                const double lambda = samples[i].lambda;
                const Xyz expected = oracle.weight(slot, lambda);
                for (std::size_t c = 0; c < 3; ++c) {
                    ASSERT_NEAR(samples[i].weight(c), expected[c],
                                oracle.weight_error(oracle.row(slot), lambda) * expected[c])
                        << of.name << ", "
                        << "XYZ"[c] << " of wavelength " << slot << " at " << lambda << " nm";
                }
            }
        }
    }
}

/// The kernel itself, in a few passes: all that a pass table holds follows from the positions and from the formulas. No
/// statistics, so that every OpenCL implementation can be asked (tests/backends_test.cpp).
TEST(SamplerTables, HoldTheWavelengthsOfThePositionsAndTheirWeights) {
    for (const bool random_sequence : {false, true}) {
        for (const SamplerCase& of : sampler_cases({4}, {"illum-mercury-lines"})) {
            const SamplerOracle oracle(of.method, of.emission);
            Passes passes(of.method, random_sequence, of.emission, {{Spectrum::constant(0.5), Passes::Use::Emission}});
            for (const std::uint32_t pass : {0U, 1U, 12345U, 0xffffffffU}) {
                passes(pass);
                const std::vector<float> positions = draw_positions(random_sequence, oracle.rotated(), Passes::seed,
                                                                    pass, static_cast<std::uint32_t>(oracle.parts()));
                for (int slot = 0; slot < passes.w(); ++slot) {
                    const double lambda = passes.lambda(slot);
                    const std::size_t row = oracle.row(slot);
                    ASSERT_NEAR(oracle.cdf(row, lambda), positions[static_cast<std::size_t>(oracle.part(slot))],
                                oracle.cdf_error(row, lambda) + 2.0 * unit_roundoff)
                        << of.name << ", wavelength " << slot << " of pass " << pass;
                    const Xyz expected = oracle.weight(slot, lambda);
                    for (std::size_t c = 0; c < 3; ++c) {
                        ASSERT_NEAR(passes.weight(c, slot), expected[c], oracle.weight_error(row, lambda) * expected[c])
                            << of.name << ", "
                            << "XYZ"[c] << " at " << lambda << " nm";
                    }
                    ASSERT_EQ(passes.spectrum(0, slot), 0.5) << of.name;
                }
            }
        }
    }
}

/// The same wavelengths and weights in every pass, those that the host derived.
TEST(SamplerTables, OfFixedWavelengthsAreTheHosts) {
    const auto expect_table = [](const Method& method, const std::vector<double>& lambdas,
                                 const std::vector<Xyz>& weights) {
        Passes passes(method, false, {}, {{Spectrum::constant(0.5), Passes::Use::Reflectance}});
        for (const std::uint32_t pass : {0U, 1U, 12345U}) {
            passes(pass);
            for (std::size_t i = 0; i < weights.size(); ++i) {
                const int slot = static_cast<int>(i);
                if (!lambdas.empty()) {
                    EXPECT_EQ(passes.lambda(slot), static_cast<float>(lambdas[i])) << method.name();
                }
                for (std::size_t c = 0; c < 3; ++c)
                    EXPECT_EQ(passes.weight(c, slot), static_cast<float>(weights[i][c])) << method.name();
            }
        }
    };
    for (int count = gauss_wavelengths_min; count <= gauss_wavelengths_max; ++count) {
        const QuadratureRule rule = gauss_rule(count);
        expect_table({Method::Kind::Gauss, count}, rule.wavelengths, rule.weights);
    }
    expect_table(parse_method("rgb"), {}, {rgb_to_xyz({1, 0, 0}), rgb_to_xyz({0, 1, 0}), rgb_to_xyz({0, 0, 1})});
}

/// Red, green and blue are seen as such by films.
TEST(SamplerTables, OfRgbPutItsBandsWhereTheyAreSeen) {
    Passes passes(parse_method("rgb"), false, {}, {{Spectrum::constant(0.5), Passes::Use::Reflectance}});
    passes(0);
    for (int band = 0; band < 3; ++band) {
        const auto bin = wavelength_bin(passes.lambda(band));
        const Rgb seen = xyz_to_rgb({cie_bins()[0][bin], cie_bins()[1][bin], cie_bins()[2][bin]});
        EXPECT_EQ(std::max_element(seen.begin(), seen.end()) - seen.begin(), band) << passes.lambda(band) << " nm";
    }
}

} // namespace
} // namespace tristim
