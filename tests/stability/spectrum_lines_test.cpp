// Spectra that are hard on the tables: lines anywhere, tables that end early, one sample, samples that touch, a million
// of them, thirty orders of magnitude both ways, black bodies of any temperature. And faults that selftest's cases see.
#include "kernel_harness.h"
#include "selftest/selftest.h"
#include "selftest/spectrum_cases.h"
#include "spectra/colour.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <random>

namespace tristim::test {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// The area of a triangle of unit area and foot [at - w/2, at + w/2] below a wavelength.
long double area_below(long double nm, long double at, long double width) {
    const long double x = std::clamp((nm - at) / width, -0.5L, 0.5L);
    return x < 0.0L ? 2.0L * (0.5L + x) * (0.5L + x) : 1.0L - 2.0L * (0.5L - x) * (0.5L - x);
}

/// Every border of bins, both ends of the table among them, with the line on it, beside it and cut by it at a quarter.
TEST(SpectrumStability, LinesKeepTheirAreaInEveryBin) {
    for (const double width : {0.01, 1e-4}) {
        double worst = 0.0;
        for (int border = 0; border <= lambda_bins; ++border) {
            for (const double shift : {-0.5, -0.25, 0.0, 0.25, 0.5, 1e4 / 3.0}) {
                const double at = lambda_min_nm + border + shift * std::min(width, 1e-4);
                const double first = at - 0.5 * width, last = at + 0.5 * width;
                const WavelengthBins bins =
                    Spectrum::piecewise_linear({first, at, last}, {0.0, 2.0 / width, 0.0}).bins();
                // The foot's ends and the border are right to half a unit of 780 each.
                const double tolerance = 4.0 * lambda_max_nm * epsilon / width;
                for (int bin = 0; bin < lambda_bins; ++bin) {
                    const double low = lambda_min_nm + bin;
                    const auto exact = static_cast<double>(area_below(static_cast<long double>(low) + 1.0L, at, width) -
                                                           area_below(low, at, width));
                    const double error = std::abs(bins[static_cast<std::size_t>(bin)] - exact);
                    ASSERT_LE(error, tolerance) << width << " nm wide at " << at << " nm, bin of " << low << " nm";
                    worst = std::max(worst, error / tolerance);
                }
            }
        }
        EXPECT_GT(worst, 1e-3) << "the tolerance is out of all proportion";
    }
}

/// ∫ of the line through samples, bin by bin in long double: a slow and plain oracle.
std::vector<long double> exact_bins(const std::vector<double>& nm, const std::vector<double>& values) {
    std::vector<long double> bins(lambda_bins, 0.0L);
    for (std::size_t i = 1; i < nm.size(); ++i) {
        const auto value = [&](long double at) {
            return values[i - 1] + (values[i] - static_cast<long double>(values[i - 1])) * (at - nm[i - 1]) /
                                       (nm[i] - static_cast<long double>(nm[i - 1]));
        };
        const double first = std::max(nm[i - 1], lambda_min_nm), last = std::min(nm[i], lambda_max_nm);
        for (auto bin = static_cast<int>(std::floor(first - lambda_min_nm)); bin < lambda_bins && first < last; ++bin) {
            const long double from = std::max<long double>(first, lambda_min_nm + bin);
            const long double to = std::min<long double>(last, lambda_min_nm + bin + 1);
            if (from >= to)
                break;
            bins[static_cast<std::size_t>(bin)] += 0.5L * (value(from) + value(to)) * (to - from);
        }
    }
    return bins;
}

/// `terms` trapezoids to a bin at most, a few roundings each; positions are right to half a unit of 780 nm, over which
/// a line of `steepest` per nm moves.
void expect_exact(const std::string& what, const std::vector<double>& nm, const std::vector<double>& values,
                  double terms, double steepest) {
    const WavelengthBins bins = Spectrum::piecewise_linear(nm, values).bins();
    const std::vector<long double> exact = exact_bins(nm, values);
    for (std::size_t i = 0; i < bins.size(); ++i) {
        const auto expected = static_cast<double>(exact[i]);
        ASSERT_NEAR(bins[i], expected,
                    (terms + 8.0) * epsilon * std::abs(expected) + lambda_max_nm * epsilon * steepest)
            << what << ", bin of " << lambda_min_nm + static_cast<double>(i) << " nm";
    }
}

TEST(SpectrumStability, TablesMayEndAnywhere) {
    for (const auto& [first, last] : {std::pair{400.0, 700.0},
                                      {300.0, 900.0},
                                      {380.0, 780.0},
                                      {400.25, 700.75},
                                      {379.5, 380.5},
                                      {779.5, 780.5},
                                      {500.2, 500.4}})
        expect_exact(fmt::format("{} to {} nm", first, last), {first, last}, {1.0, 3.0}, 1.0, 4.0 / (last - first));
    // What lies outside of the visible range does not count, nor does it lead to anything but zero.
    for (const auto& [first, last] : {std::pair{100.0, 380.0}, {780.0, 2000.0}, {1e-3, 2e-3}}) {
        const Spectrum outside = Spectrum::piecewise_linear({first, last}, {5.0, 5.0});
        EXPECT_EQ(spectrum_to_xyz(outside), Xyz{}) << first;
    }
}

/// Light over 400 to 700 nm alone is what the observer sees of the same light over 300 to 900 nm there.
TEST(SpectrumStability, IlluminantAndObserverMayEndApart) {
    const Xyz narrow = spectrum_to_xyz(Spectrum::piecewise_linear({400.0, 700.0}, {2.0, 2.0}));
    const Xyz wide = spectrum_to_xyz(Spectrum::piecewise_linear({300.0, 900.0}, {2.0, 2.0}));
    const Xyz all = spectrum_to_xyz(Spectrum::constant(2.0));
    for (std::size_t c = 0; c < 3; ++c) {
        double inside = 0.0;
        for (std::size_t i = 20; i < 320; ++i)
            inside += 2.0 * cie_bins()[c][i] / cie_y_integral();
        EXPECT_NEAR(narrow[c], inside, 400.0 * epsilon * inside);
        EXPECT_NEAR(wide[c], all[c], 400.0 * epsilon * all[c]);
    }
}

TEST(SpectrumStability, OneSampleHoldsNoLightAndTwoThatTouchHoldTheirs) {
    const Spectrum one = Spectrum::piecewise_linear({550.5}, {7.0});
    EXPECT_EQ(one.bins(), WavelengthBins{});
    EXPECT_EQ(one(550.5), 7.0);
    EXPECT_EQ(one.mean(550.5, 550.5), 7.0);
    EXPECT_EQ(one.minimum(550.5, 550.5), 7.0);
    for (const double at : {380.0, 550.0, 550.5, 780.0 - 1e-9}) {
        const double last = at + 1e-9, width = last - at;
        const WavelengthBins bins = Spectrum::piecewise_linear({at, last}, {4.0, 6.0}).bins();
        const auto bin = static_cast<std::size_t>(at - lambda_min_nm);
        // A millionth of the width between two wavelengths is below a unit of theirs: the area is right to 1e-16 · 780
        // / 1e-9 of it at most, and nothing is lost to other bins.
        EXPECT_NEAR(bins[bin], 5.0 * width, 8.0 * epsilon * width + 6.0 * epsilon * lambda_max_nm) << at;
        for (std::size_t i = 0; i < bins.size(); ++i) {
            if (i != bin) {
                EXPECT_EQ(bins[i], 0.0) << at << ", bin " << i;
            }
        }
    }
}

/// A million samples, of which each bin holds 1900.
TEST(SpectrumStability, MillionsOfSamplesAreIntegratedExactly) {
    std::mt19937_64 engine(11);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    constexpr std::size_t count = 1'000'000;
    constexpr double step = 530.0 / count;
    std::vector<double> nm, values;
    for (std::size_t i = 0; i < count; ++i) {
        nm.push_back(330.0 + step * (static_cast<double>(i) + 0.9 * uniform(engine)));
        values.push_back(uniform(engine));
    }
    expect_exact("a million samples", nm, values, 2000.0, 2000.0 * 10.0 / step * 1e-3);
}

TEST(SpectrumStability, ThirtyOrdersOfMagnitudeBothWays) {
    std::vector<double> nm, values;
    for (int i = 0; i < 120; ++i) {
        nm.push_back(370.3 + 3.7 * i);
        values.push_back(i % 2 == 0 ? 1e-30 : 1e30);
    }
    expect_exact("1e-30 and 1e30 in turns", nm, values, 2.0, 1e30);
    // Each by itself: relative to the values there.
    expect_exact("1e-30", {300.0, 500.0, 900.0}, {1e-30, 3e-30, 2e-30}, 2.0, 1e-32);
    expect_exact("1e30", {300.0, 500.0, 900.0}, {1e30, 3e30, 2e30}, 2.0, 1e28);
}

/// Planck's law relative to its value at 780 nm, from 1 K, where nothing is visible, to 10⁶ K, where λ⁻⁴ is left of it.
TEST(SpectrumStability, BlackBodiesOfAnyTemperature) {
    const auto planck = [](long double nm, long double kelvin) {
        return std::pow(nm / 780.0L, -5.0L) / std::expm1(1.438776877e7L / (nm * kelvin));
    };
    EXPECT_EQ(spectrum_to_xyz(Spectrum::blackbody(1.0)), Xyz{});
    for (const double kelvin : {100.0, 300.0, 1000.0, 6500.0, 25000.0, 1e5, 1e6, 1e9}) {
        const Spectrum body = Spectrum::blackbody(kelvin);
        for (const double nm : {380.0, 450.0, 555.0, 650.0, 779.0}) {
            const auto expected = static_cast<double>(planck(nm, kelvin) / planck(780.0L, kelvin));
            // x = c₂/(λT), at most 379, is rounded three times and stands in an exponent.
            EXPECT_NEAR(body(nm) / body(780.0), expected, 1500.0 * epsilon * expected)
                << kelvin << " K, " << nm << " nm";
        }
        for (const double bin : body.bins())
            EXPECT_TRUE(std::isfinite(bin) && bin > 0.0) << kelvin;
    }
}

/// The last two fields of each line of a file that `tristim selftest --curves` wrote: parameter and error.
std::vector<selftest::CurvePoint> curve_of(const std::string& file) {
    std::ifstream lines(std::string(TRISTIM_SOURCE_DIR "/tests/stability/data/") + file);
    std::vector<selftest::CurvePoint> curve;
    std::string line;
    for (std::getline(lines, line); std::getline(lines, line);) {
        const std::size_t last = line.rfind(','), before = line.rfind(',', last - 1);
        curve.push_back({std::stod(line.substr(before + 1)), std::stod(line.substr(last + 1))});
    }
    return curve;
}

/// Curves from before inverse CDFs had 31 digits: with floats, dark bins were drawn by up to a half too often or too
/// seldom, and those below 2^-24 never. Today the errors are below the bound everywhere.
TEST(SpectrumStability, CurvesThatBrokeAreBelowTheirBoundsToday) {
    const std::vector<std::pair<std::string, std::string>> broken{
        {"inverse CDFs of tables, u = 0 to 1", "spectrum-inverse-before.csv"},
        {"lines, 380 to 780 nm, samplers with tables", "spectrum-lines-before.csv"}};
    for (const auto& [name, file] : broken) {
        const std::vector<selftest::CurvePoint> before = curve_of(file);
        ASSERT_GT(before.size(), 60U) << file;
        const std::vector<selftest::Case> cases = selftest::spectrum_cases();
        const auto found =
            std::find_if(cases.begin(), cases.end(), [&](const selftest::Case& c) { return c.name == name; });
        ASSERT_NE(found, cases.end()) << name;
        const auto broke = std::count_if(before.begin(), before.end(),
                                         [&](const selftest::CurvePoint& point) { return point.error > found->bound; });
        EXPECT_GT(broke, static_cast<std::ptrdiff_t>(before.size() / 4)) << name;
        const selftest::Outcome today = selftest::run(*found, {kernel_test::test_device(), false, 1.0});
        ASSERT_EQ(today.found.curve.size(), before.size()) << name << ": " << today.failure;
        for (std::size_t i = 0; i < before.size(); ++i) {
            EXPECT_NEAR(today.found.curve[i].parameter, before[i].parameter, 1e-5 * before[i].parameter) << name;
            EXPECT_LE(today.found.curve[i].error, found->bound) << name << " at " << before[i].parameter;
        }
    }
}

/// The names of the cases whose bound a change to kernels/selftest/spectrum.cl breaks.
std::vector<std::string> broken_by(const std::string& from, const std::string& to) {
    std::string source = flatten_kernel_source("selftest/spectrum.cl");
    const std::size_t at = source.find(from);
    EXPECT_NE(at, std::string::npos) << "the kernels no longer say " << from;
    if (at != std::string::npos)
        source.replace(at, from.size(), to);
    const auto cores = [&](const selftest::Setting&) {
        return kernel_test::build_test_program(source, selftest::spectrum_macros());
    };
    std::vector<std::string> broken;
    for (const selftest::Case& c : selftest::spectrum_cases(cores)) {
        const selftest::Outcome outcome = selftest::run(c, {kernel_test::test_device(), false, 0.1});
        EXPECT_EQ(outcome.failure, "") << c.name;
        if (!outcome.passed())
            broken.push_back(c.name);
    }
    return broken;
}

TEST(SpectrumStability, FaultsAreCaught) {
    using Names = std::vector<std::string>;
    const std::string of_tables = "inverse CDFs of tables, u = 0 to 1",
                      closed = "inverse CDFs in closed form, u = 0 to 1";
    const std::string table_lines = "lines, 380 to 780 nm, samplers with tables";
    const std::string closed_lines = "lines, 380 to 780 nm, other samplers", knots = "tables at their knots and ends";
    EXPECT_EQ(broken_by("position >> 1", "position >> 1"), Names{}) << "without any change";
    // Positions with no more digits than a float has.
    EXPECT_EQ(broken_by("position >> 1", "position >> 9 << 8"), (Names{of_tables, table_lines}));
    // A wavelength that rounds up into the next bin, and one that never comes near it.
    EXPECT_EQ(broken_by("0.0f, WITHIN_BIN)", "0.0f, 1.0f)"), Names{table_lines});
    EXPECT_EQ(broken_by("0.0f, WITHIN_BIN)", "0.0f, 0.999f)"), Names{of_tables});
    // A pdf that is off by a few thousandths.
    EXPECT_EQ(broken_by("share * 0x1p-31f", "share * 0x1.01p-31f"), Names{table_lines});
    EXPECT_EQ(broken_by("slope * (1.0f - t * t)", "slope * (1.004f - t * t)"), Names{closed_lines});
    EXPECT_EQ(broken_by("lambda - LAMBDA_MIN - 0.5f", "lambda - LAMBDA_MIN - 0.499f"), Names{knots});
}

} // namespace
} // namespace tristim::test
