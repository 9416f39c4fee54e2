#include "spectra/colour.h"

#include <gtest/gtest.h>

#include <tuple>

namespace tristim {
namespace {

std::array<double, 2> chromaticity(const Xyz& xyz) {
    const double sum = xyz[0] + xyz[1] + xyz[2];
    return {xyz[0] / sum, xyz[1] / sum};
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

} // namespace
} // namespace tristim
