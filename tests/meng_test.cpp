// The smoothest reflectances (Meng et al. 2015): a certificate that no reflectance of the same colour is smoother.
#include "spectra/rgb_upsampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace tristim::test {
namespace {

constexpr int samples = 81; // every 5 nm from 380 to 780

using Samples = std::array<double, samples>;

double wavelength(int sample) {
    return 380.0 + 5.0 * sample;
}

Samples samples_of(const Spectrum& spectrum) {
    Samples s{};
    for (int i = 0; i < samples; ++i)
        s[static_cast<std::size_t>(i)] = spectrum(wavelength(i));
    return s;
}

double roughness(const Samples& s) {
    double sum = 0.0;
    for (std::size_t i = 1; i < s.size(); ++i)
        sum += (s[i] - s[i - 1]) * (s[i] - s[i - 1]);
    return sum;
}

/// XYZ under D65 of each sample: the renderer's sum for the reflectance that is 1 there, 0 at the other samples.
const std::array<Samples, 3>& xyz_of_samples() {
    static const std::array<Samples, 3> table = [] {
        std::array<Samples, 3> weights{};
        const auto d65 = Spectrum::rgb_illuminant_white().bins();
        for (int i = 0; i < samples; ++i) {
            const double at = wavelength(i);
            const auto tent = Spectrum::piecewise_linear({at - 5.0, at, at + 5.0}, {0.0, 1.0, 0.0}).bins();
            for (std::size_t channel = 0; channel < 3; ++channel) {
                for (std::size_t bin = 0; bin < tent.size(); ++bin)
                    weights[channel][static_cast<std::size_t>(i)] += tent[bin] * d65[bin] * cie_bins()[channel][bin];
            }
        }
        return weights;
    }();
    return table;
}

/// Half the roughness's gradient: L s.
Samples gradient(const Samples& s) {
    Samples g{};
    for (std::size_t i = 0; i < s.size(); ++i) {
        if (i > 0)
            g[i] += s[i] - s[i - 1];
        if (i + 1 < s.size())
            g[i] += s[i] - s[i + 1];
    }
    return g;
}

/// The multipliers μ of XYZ by least squares from samples strictly within (0, 1), where L s = Aᵀμ: orthogonal rows by
/// Gram and Schmidt.
Samples explained_gradient(const Samples& s) {
    const Samples g = gradient(s);
    std::vector<std::size_t> inner;
    for (std::size_t i = 0; i < s.size(); ++i) {
        if (s[i] > 0.0 && s[i] < 1.0)
            inner.push_back(i);
    }
    Samples explained{};
    std::array<Samples, 3> rows = xyz_of_samples();
    const auto inner_product = [&](const Samples& a, const Samples& b) {
        double sum = 0.0;
        for (const std::size_t i : inner)
            sum += a[i] * b[i];
        return sum;
    };
    for (std::size_t row = 0; row < rows.size(); ++row) {
        for (std::size_t before = 0; before < row; ++before) {
            const double share = inner_product(rows[row], rows[before]) / inner_product(rows[before], rows[before]);
            for (std::size_t i = 0; i < s.size(); ++i)
                rows[row][i] -= share * rows[before][i];
        }
        const double share = inner_product(g, rows[row]) / inner_product(rows[row], rows[row]);
        for (std::size_t i = 0; i < s.size(); ++i)
            explained[i] += share * rows[row][i];
    }
    return explained;
}

std::vector<Rgb> colours() {
    std::vector<Rgb> all;
    for (int i = 1; i < 7; ++i) // the corners of the cube but black and white
        all.push_back({i & 1 ? 1.0 : 0.0, i & 2 ? 1.0 : 0.0, i & 4 ? 1.0 : 0.0});
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    std::uniform_int_distribution<int> edge(0, 3);
    for (int i = 0; i < 300; ++i) {
        Rgb rgb{};
        for (double& value : rgb) {
            const int kind = edge(random);
            value = kind == 0 ? 0.0 : kind == 1 ? 1.0 : uniform(random);
        }
        if (rgb[0] != rgb[1] || rgb[1] != rgb[2])
            all.push_back(rgb);
    }
    return all;
}

/// The conditions of Karush, Kuhn and Tucker are enough for a minimum of a convex function on a convex set: no spectrum
/// of the same XYZ within [0, 1] is smoother.
TEST(Meng, NoReflectanceOfTheColourIsSmoother) {
    int held_at_zero = 0;
    int held_at_one = 0;
    for (const Rgb& rgb : colours()) {
        const Samples s = samples_of(meng_reflectance(rgb));
        const Samples g = gradient(s);
        const Samples explained = explained_gradient(s);
        for (std::size_t i = 0; i < s.size(); ++i) {
            // Gradients are below 0.2. The linear equations' condition, ~1e4, takes 1e-16 to 1e-12.
            constexpr double rounding = 1e-10;
            const double multiplier = g[i] - explained[i];
            if (s[i] == 0.0) {
                ++held_at_zero;
                EXPECT_GE(multiplier, -rounding) << wavelength(static_cast<int>(i)) << " nm";
            } else if (s[i] == 1.0) {
                ++held_at_one;
                EXPECT_LE(multiplier, rounding) << wavelength(static_cast<int>(i)) << " nm";
            } else {
                EXPECT_NEAR(multiplier, 0.0, rounding) << wavelength(static_cast<int>(i)) << " nm";
            }
        }
    }
    // Both bounds were at work.
    EXPECT_GT(held_at_zero, 1000);
    EXPECT_GT(held_at_one, 1000);
}

/// The certificate's own check: of Jakob and Hanika's reflectances of the same colours none is smoother.
TEST(Meng, IsSmootherThanTheSigmoid) {
    for (const Rgb& rgb : colours()) {
        const Samples smoothest = samples_of(meng_reflectance(rgb));
        EXPECT_LT(roughness(smoothest), roughness(samples_of(jakob_hanika_reflectance(rgb))))
            << rgb[0] << ' ' << rgb[1] << ' ' << rgb[2];
    }
}

TEST(Meng, IsLinearBetweenItsSamplesAndConstantBeyond) {
    const Spectrum spectrum = meng_reflectance({0.9, 0.3, 0.05});
    const Samples s = samples_of(spectrum);
    for (std::size_t i = 0; i + 1 < s.size(); ++i) {
        const double at = wavelength(static_cast<int>(i));
        for (const double share : {0.2, 0.5, 0.9})
            EXPECT_NEAR(spectrum(at + 5.0 * share), std::lerp(s[i], s[i + 1], share), 1e-14);
    }
    EXPECT_EQ(spectrum(360.0), s.front());
    EXPECT_EQ(spectrum(830.0), s.back());
}

/// Values at 400, 450, …, 700 nm by an interior-point method (CVXOPT 1.3), from the tables of D65 and of the colour
/// matching functions on its own; sequential least squares (SciPy's SLSQP) has the same within 1e-7.
TEST(Meng, AgreesWithAnotherSolver) {
    struct Case {
        Rgb rgb;
        std::array<double, 7> values;
    };
    const Case cases[] = {
        {{1.0, 0.0, 0.0}, {0.062233, 0.012850, 0.0, 0.0, 0.725348, 1.0, 1.0}},
        {{0.0, 1.0, 0.0}, {0.0, 0.0, 0.761558, 1.0, 0.287587, 0.0, 0.0}},
        {{0.0, 0.0, 1.0}, {1.0, 0.997262, 0.322098, 0.0, 0.004812, 0.056251, 0.061891}},
        {{0.0, 1.0, 1.0}, {0.937767, 0.987150, 1.0, 1.0, 0.274652, 0.0, 0.0}},
        {{0.8, 0.2, 0.1}, {0.148511, 0.131817, 0.079690, 0.234908, 0.590389, 0.727183, 0.737035}},
        {{0.05, 0.5, 0.3}, {0.240896, 0.283420, 0.487220, 0.487273, 0.201344, 0.078050, 0.069015}},
    };
    for (const Case& c : cases) {
        const Spectrum spectrum = meng_reflectance(c.rgb);
        for (std::size_t i = 0; i < c.values.size(); ++i)
            EXPECT_NEAR(spectrum(400.0 + 50.0 * static_cast<double>(i)), c.values[i], 7e-7) << "case " << &c - cases;
    }
}

/// Emission is scaled from colours whose largest value is 1/2. There the bound of 1 must not show, so that it is the
/// smoothest of all non-negative spectra of the colour: the largest reflectance, that of (1/2, 0, 0), is 0.6.
TEST(Meng, ScaledColoursDoNotFeelTheUpperBound) {
    for (int r = 0; r <= 16; ++r) {
        for (int g = 0; g <= 16; ++g) {
            for (int b = 0; b <= 16; ++b) {
                if (std::max({r, g, b}) != 16 || (r == g && g == b))
                    continue;
                const Spectrum spectrum = meng_reflectance({r / 32.0, g / 32.0, b / 32.0});
                ASSERT_GT(spectrum.scaled(-1.0).minimum(360.0, 830.0), -0.7) << r << ' ' << g << ' ' << b;
            }
        }
    }
}

} // namespace
} // namespace tristim::test
