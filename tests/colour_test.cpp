#include "base/error.h"
#include "spectra/colour.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <tuple>

namespace tristim {
namespace {

/// XYZ of a reflectance under D65, as a renderer that works in 1 nm bins sums it; Y of the white is 1.
Xyz reflected_xyz(const Spectrum& reflectance) {
    const auto bins = reflectance.bins();
    const auto d65 = Spectrum::rgb_illuminant_white().bins();
    Xyz xyz{};
    for (std::size_t channel = 0; channel < 3; ++channel) {
        for (std::size_t i = 0; i < bins.size(); ++i)
            xyz[channel] += bins[i] * d65[i] * cie_bins()[channel][i] / cie_y_integral();
    }
    return xyz;
}

/// CIE 1976 L*a*b* (CIE 15:2018).
std::array<double, 3> lab(const Xyz& xyz, const Xyz& white) {
    std::array<double, 3> f{};
    for (std::size_t i = 0; i < 3; ++i) {
        const double ratio = xyz[i] / white[i];
        f[i] = ratio > std::pow(6.0 / 29.0, 3) ? std::cbrt(ratio) : ratio * (841.0 / 108.0) + 4.0 / 29.0;
    }
    return {116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])};
}

double delta_e(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

std::array<double, 2> chromaticity(const Xyz& xyz) {
    const double sum = xyz[0] + xyz[1] + xyz[2];
    return {xyz[0] / sum, xyz[1] / sum};
}

bool throws_error(const std::function<void()>& call) {
    try {
        call();
    } catch (const Error&) {
        return true;
    }
    return false;
}

TEST(Colour, MatchingFunctionsHaveThePublishedSums) {
    // CIE 15: the 1 nm functions sum to 106.857 (ȳ) over 360–830 nm, x̄ and z̄ to 106.865 and 106.892.
    const double published[] = {106.865, 106.857, 106.892};
    const char* names[] = {"cie-x", "cie-y", "cie-z"};
    for (int channel = 0; channel < 3; ++channel) {
        const Spectrum function = Spectrum::named(names[channel]);
        double sum = 0.0;
        for (int lambda = 360; lambda <= 830; ++lambda)
            sum += function(lambda);
        EXPECT_NEAR(sum, published[channel], 5e-4) << names[channel];
    }
    EXPECT_EQ(Spectrum::named("cie-y")(555.0), 1.0);
}

TEST(Colour, BinsAreMeansOfTheTable) {
    const Spectrum y = Spectrum::named("cie-y");
    for (int i = 0; i < lambda_bins; ++i) {
        const double mean = 0.5 * (y(lambda_min_nm + i) + y(lambda_min_nm + i + 1));
        EXPECT_NEAR(cie_bins()[1][static_cast<std::size_t>(i)], mean, 1e-15);
    }
    EXPECT_NEAR(cie_y_integral(), y.mean(lambda_min_nm, lambda_max_nm) * 400.0, 1e-10);
}

TEST(Colour, ConstantOneHasLuminanceOne) {
    const Xyz xyz = spectrum_to_xyz(Spectrum::constant(1.0));
    EXPECT_NEAR(xyz[1], 1.0, 1e-14); // a sum of 400 terms
    // Equal-energy white is x = y = 1/3; the functions' integrals differ by 0.033 %.
    EXPECT_NEAR(chromaticity(xyz)[0], 1.0 / 3.0, 1e-4);
    EXPECT_NEAR(chromaticity(xyz)[1], 1.0 / 3.0, 1e-4);
}

TEST(Colour, TristimulusValuesAreTheSumOverBins) {
    // F11 has the strongest lines. Its knots are whole nanometres, so a bin's mean is that of its two ends.
    const Spectrum lamp = Spectrum::named("stdillum-F11");
    const Xyz xyz = spectrum_to_xyz(lamp);
    const char* names[] = {"cie-x", "cie-y", "cie-z"};
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const Spectrum function = Spectrum::named(names[channel]);
        double sum = 0.0;
        double k = 0.0;
        for (int lambda = 380; lambda < 780; ++lambda) {
            sum += 0.25 * (lamp(lambda) + lamp(lambda + 1)) * (function(lambda) + function(lambda + 1));
            k += 0.5 * (Spectrum::named("cie-y")(lambda) + Spectrum::named("cie-y")(lambda + 1));
        }
        EXPECT_NEAR(xyz[channel], sum / k, 1e-12);
    }
    EXPECT_NEAR(xyz[1], 1.0, 1e-12); // named illuminants have Y = 1
}

TEST(Colour, IlluminantsHavePublishedWhitePoints) {
    // CIE 15:2018, 2° observer, from the CIE's own sums: every 5 nm for A and D, every 1 nm for the fluorescent lamps.
    // Printed to five decimals, of spectra printed to five digits (A, D) or 0.01 (F): one unit of the last decimal.
    const std::tuple<const char*, int, double, double> published[] = {
        {"stdillum-A", 5, 0.44757, 0.40745},   {"stdillum-D50", 5, 0.34567, 0.35851},
        {"stdillum-D65", 5, 0.31272, 0.32903}, {"stdillum-F1", 1, 0.31310, 0.33727},
        {"stdillum-F2", 1, 0.37208, 0.37529},  {"stdillum-F3", 1, 0.40910, 0.39430},
        {"stdillum-F7", 1, 0.31292, 0.32933},  {"stdillum-F11", 1, 0.38052, 0.37713},
        {"stdillum-F12", 1, 0.43695, 0.40441},
    };
    const Spectrum functions[] = {Spectrum::named("cie-x"), Spectrum::named("cie-y"), Spectrum::named("cie-z")};
    for (const auto& [name, step, x, y] : published) {
        const Spectrum lamp = Spectrum::named(name);
        Xyz xyz{};
        for (int lambda = 380; lambda <= 780; lambda += step) {
            for (std::size_t channel = 0; channel < 3; ++channel)
                xyz[channel] += lamp(lambda) * functions[channel](lambda);
        }
        EXPECT_NEAR(chromaticity(xyz)[0], x, 1e-5) << name;
        EXPECT_NEAR(chromaticity(xyz)[1], y, 1e-5) << name;
    }
}

TEST(Colour, SrgbMatricesAreThePublishedOnes) {
    // IEC 61966-2-1 prints four decimals.
    const Matrix3 to_xyz{{{0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}}};
    const Matrix3 to_rgb{{{3.2406, -1.5372, -0.4986}, {-0.9689, 1.8758, 0.0415}, {0.0557, -0.2040, 1.0570}}};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            EXPECT_NEAR(rgb_to_xyz_matrix()[i][j], to_xyz[i][j], 5e-5);
            // The standard inverted its rounded matrix: an error of 5e-5 grows by the row's and column's size, ~3.2².
            EXPECT_NEAR(xyz_to_rgb_matrix()[i][j], to_rgb[i][j], 5e-4);
        }
    }
    const Rgb rgb{0.2, 0.7, 0.05};
    const Rgb back = xyz_to_rgb(rgb_to_xyz(rgb));
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(back[i], rgb[i], 1e-14);
    EXPECT_NEAR(rgb_to_xyz({1.0, 1.0, 1.0})[1], 1.0, 1e-14);
    EXPECT_NEAR(chromaticity(rgb_to_xyz({1.0, 1.0, 1.0}))[0], 0.3127, 1e-14);
    EXPECT_NEAR(chromaticity(rgb_to_xyz({0.0, 1.0, 0.0}))[1], 0.6, 1e-14);
}

TEST(RgbSpectrum, GreyIsExactlyConstant) {
    for (const double grey : {0.0, 0.1, 0.5, 0.75, 1.0}) {
        const Spectrum spectrum = Spectrum::rgb_albedo({grey, grey, grey});
        EXPECT_TRUE(spectrum.is_constant());
        EXPECT_EQ(spectrum(555.0), grey);
    }
    EXPECT_TRUE(Spectrum::rgb_unbounded({7.0, 7.0, 7.0}).is_constant());
    EXPECT_EQ(Spectrum::rgb_unbounded({7.0, 7.0, 7.0})(600.0), 7.0);
    EXPECT_EQ(Spectrum::rgb_unbounded({0.0, 0.0, 0.0})(600.0), 0.0);
    EXPECT_FALSE(Spectrum::rgb_albedo({0.5, 0.5, 0.6}).is_constant());
}

TEST(RgbSpectrum, ReflectanceReproducesTheColour) {
    // Every colour of the grid, the corners of the cube among them. The fit stops within 1e-6 of the colour; what is
    // left is the standard's white (0.3127, 0.3290) against the one of the D65 table, (0.31274, 0.32906): the latter
    // differ in Lab by Δa ≈ 0.02, Δb ≈ 0.03.
    const Xyz white = rgb_to_xyz({1.0, 1.0, 1.0});
    const Xyz d65 = spectrum_to_xyz(Spectrum::named("stdillum-D65"));
    const Matrix3 rgb_to_xyz_d65 = rgb_to_xyz_matrix(d65);
    double worst = 0.0;
    double worst_fit = 0.0;
    for (int r = 0; r <= 8; ++r) {
        for (int g = 0; g <= 8; ++g) {
            for (int b = 0; b <= 8; ++b) {
                const Rgb rgb{r / 8.0, g / 8.0, b / 8.0};
                const Spectrum spectrum = Spectrum::rgb_albedo(rgb);
                const Xyz xyz = reflected_xyz(spectrum);
                Xyz expected{};
                for (std::size_t i = 0; i < 3; ++i) {
                    for (std::size_t j = 0; j < 3; ++j)
                        expected[i] += rgb_to_xyz_d65[i][j] * rgb[j];
                }
                worst = std::max(worst, delta_e(lab(xyz, d65), lab(rgb_to_xyz(rgb), white)));
                worst = std::max(worst, delta_e(lab(xyz, white), lab(rgb_to_xyz(rgb), white)));
                worst_fit = std::max(worst_fit, delta_e(lab(xyz, d65), lab(expected, d65)));
                for (const double value : spectrum.bins())
                    ASSERT_TRUE(value >= 0.0 && value <= 1.0);
            }
        }
    }
    RecordProperty("worst_delta_e", std::to_string(worst));
    RecordProperty("worst_fit_delta_e", std::to_string(worst_fit));
    EXPECT_LT(worst, 0.5);
    EXPECT_LT(worst_fit, 2e-6);
}

TEST(RgbSpectrum, ReflectanceReproducesColoursBesideGreyAndAtTheBorder) {
    const Xyz d65 = spectrum_to_xyz(Spectrum::named("stdillum-D65"));
    const Matrix3 rgb_to_xyz_d65 = rgb_to_xyz_matrix(d65);
    const double levels[] = {0.0, 1e-300, 1e-9, 1e-3, 0.5, 1.0 - 1e-3, 1.0 - 1e-9, std::nextafter(1.0, 0.0), 1.0};
    for (const double r : levels) {
        for (const double g : levels) {
            for (const double b : levels) {
                const Xyz xyz = reflected_xyz(Spectrum::rgb_albedo({r, g, b}));
                Xyz expected{};
                for (std::size_t i = 0; i < 3; ++i)
                    expected[i] = rgb_to_xyz_d65[i][0] * r + rgb_to_xyz_d65[i][1] * g + rgb_to_xyz_d65[i][2] * b;
                EXPECT_LT(delta_e(lab(xyz, d65), lab(expected, d65)), 2e-6) << r << ' ' << g << ' ' << b;
            }
        }
    }
}

TEST(RgbSpectrum, ReflectanceIsSmooth) {
    // The sigmoid of a quadratic has at most two flanks (Jakob & Hanika 2019): its samples turn at most once.
    for (const Rgb& rgb : {Rgb{0.8, 0.2, 0.1}, Rgb{0.1, 0.9, 0.3}, Rgb{0.0, 0.0, 1.0}, Rgb{1.0, 1.0, 0.0}}) {
        const auto bins = Spectrum::rgb_albedo(rgb).bins();
        int turns = 0;
        double direction = 0.0;
        for (std::size_t i = 1; i < bins.size(); ++i) {
            const double step = bins[i] - bins[i - 1];
            if (step * direction < 0.0)
                ++turns;
            if (step != 0.0)
                direction = step;
        }
        EXPECT_LE(turns, 1);
    }
}

TEST(RgbSpectrum, IlluminantHasTheColour) {
    // Emission of (1, 1, 1) is D65 with Y = 1, so the emission of a colour has the XYZ of the colour.
    const Spectrum white = Spectrum::rgb_illuminant({1.0, 1.0, 1.0});
    EXPECT_EQ(white(500.0), Spectrum::rgb_illuminant_white()(500.0));
    EXPECT_NEAR(spectrum_to_xyz(white)[1], 1.0, 1e-12);
    const Rgb rgb{30.0, 12.0, 3.0};
    const Matrix3 rgb_to_xyz_d65 = rgb_to_xyz_matrix(spectrum_to_xyz(white));
    const Xyz xyz = spectrum_to_xyz(Spectrum::rgb_illuminant(rgb));
    for (std::size_t i = 0; i < 3; ++i) {
        const double expected =
            rgb_to_xyz_d65[i][0] * rgb[0] + rgb_to_xyz_d65[i][1] * rgb[1] + rgb_to_xyz_d65[i][2] * rgb[2];
        // In a bin the mean of the product (here) and the product of the means (the fit) differ by up to a quarter of
        // the product of the slopes: of D65 at most 0.029 nm⁻¹, of this colour's sigmoid 0.0035 nm⁻¹, times m = 60.
        EXPECT_NEAR(xyz[i], expected, 60.0 * 0.25 * 0.029 * 0.0035);
    }
}

TEST(RgbSpectrum, UnboundedIsTheScaledReflectance) {
    const Spectrum unbounded = Spectrum::rgb_unbounded({4.0, 1.0, 2.0});
    const Spectrum albedo = Spectrum::rgb_albedo({0.5, 0.125, 0.25});
    for (const double lambda : {400.0, 500.5, 700.0})
        EXPECT_DOUBLE_EQ(unbounded(lambda), 8.0 * albedo(lambda));
}

TEST(RgbSpectrum, RefusesColoursOutOfRange) {
    const double nan = std::nan("");
    EXPECT_TRUE(throws_error([] { Spectrum::rgb_albedo({1.0001, 0.0, 0.0}); }));
    EXPECT_TRUE(throws_error([] { Spectrum::rgb_albedo({0.0, -1e-9, 0.0}); }));
    EXPECT_TRUE(throws_error([&] { Spectrum::rgb_albedo({0.0, nan, 0.0}); }));
    EXPECT_TRUE(throws_error([] { Spectrum::rgb_illuminant({-1.0, 0.0, 0.0}); }));
    EXPECT_TRUE(throws_error([&] { Spectrum::rgb_unbounded({0.0, 0.0, nan}); }));
    EXPECT_FALSE(throws_error([] { Spectrum::rgb_unbounded({100.0, 0.0, 0.0}); }));
}

} // namespace
} // namespace tristim
