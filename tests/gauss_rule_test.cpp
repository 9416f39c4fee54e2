#include "base/error.h"
#include "colour_difference.h"
#include "spectra/gauss_rule.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace tristim {
namespace {

using Real = long double;

constexpr std::array<int, 4> counts{4, 5, 6, 7};
static_assert(counts.front() == gauss_wavelengths_min && counts.back() == gauss_wavelengths_max);

/// Meyer's opponent space: A, C1, C2 from XYZ.
constexpr Matrix3 opponent_matrix{{{-0.0177, 1.0090, 0.0073}, {-1.5370, 1.0821, 0.3209}, {0.1946, -0.2045, 0.5264}}};

double opponent(std::size_t channel, const Xyz& xyz) {
    const auto& row = opponent_matrix[channel];
    return row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2];
}

/// The oracle's variable, another than the rule's: in nm from the middle of the spectrum, over 100.
Real t_of(Real lambda_nm) {
    return (lambda_nm - 560.0L) / 100.0L;
}

/// A channel's matching function as point masses.
struct Measure {
    std::vector<Real> t;
    std::vector<Real> mass;

    Real integral(const std::function<Real(Real)>& f) const {
        Real sum = 0.0L;
        for (std::size_t i = 0; i < t.size(); ++i)
            sum += mass[i] * f(t[i]);
        return sum;
    }
};

/// The renderer's measure: constant in each bin. Three-point Gauss-Legendre quadrature in a bin is exact to degree 5
/// and errs by less than 1e-12 for t^9.
Measure bin_measure(std::size_t channel) {
    const Real offset = std::sqrt(0.6L) / 2.0L;
    const std::array<std::array<Real, 2>, 3> points{{{-offset, 5.0L}, {0.0L, 8.0L}, {offset, 5.0L}}};
    Measure measure;
    for (std::size_t bin = 0; bin < lambda_bins; ++bin) {
        const Xyz xyz{cie_bins()[0][bin], cie_bins()[1][bin], cie_bins()[2][bin]};
        const Real mass = static_cast<Real>(opponent(channel, xyz) / cie_y_integral());
        const Real middle = static_cast<Real>(lambda_min_nm) + static_cast<Real>(bin) + 0.5L;
        for (const auto& [from_middle, weight] : points) {
            measure.t.push_back(t_of(middle + from_middle));
            measure.mass.push_back(mass * weight / 18.0L);
        }
    }
    return measure;
}

/// Sums over a table every 5 nm from 380 to 770 nm, as colorimetry was done by hand; Y of a constant 1 is 1.
Measure table_measure(std::size_t channel) {
    const Spectrum functions[] = {Spectrum::named("cie-x"), Spectrum::named("cie-y"), Spectrum::named("cie-z")};
    Measure measure;
    double y_sum = 0.0;
    for (int lambda = 380; lambda <= 770; lambda += 5)
        y_sum += functions[1](lambda);
    for (int lambda = 380; lambda <= 770; lambda += 5) {
        measure.t.push_back(t_of(lambda));
        const Xyz xyz{functions[0](lambda), functions[1](lambda), functions[2](lambda)};
        measure.mass.push_back(static_cast<Real>(opponent(channel, xyz) / y_sum));
    }
    return measure;
}

/// The real zeros, in nm from 300 to 1100, of the n-th orthogonal polynomial, by the Stieltjes procedure (Gautschi
/// 1982): p_{k+1} = (t - a_k) p_k - b_k p_{k-1}.
std::vector<double> gaussian_nodes(const Measure& measure, std::size_t n) {
    std::vector<Real> a;
    std::vector<Real> b;
    const auto polynomial = [&](Real t, std::size_t degree) {
        Real previous = 0.0L;
        Real value = 1.0L;
        for (std::size_t k = 0; k < degree; ++k)
            previous = std::exchange(value, (t - a[k]) * value - b[k] * previous);
        return value;
    };
    Real last_norm = 1.0L;
    for (std::size_t k = 0; k < n; ++k) {
        const Real norm = measure.integral([&](Real t) { return polynomial(t, k) * polynomial(t, k); });
        const Real mean = measure.integral([&](Real t) { return t * polynomial(t, k) * polynomial(t, k); });
        a.push_back(mean / norm);
        b.push_back(k == 0 ? 0.0L : norm / last_norm);
        last_norm = norm;
    }
    std::vector<double> nodes;
    for (Real lambda = 300.0L; lambda < 1100.0L; lambda += 0.5L) {
        Real low = lambda;
        Real high = lambda + 0.5L;
        if (polynomial(t_of(low), n) * polynomial(t_of(high), n) > 0.0L)
            continue;
        for (int i = 0; i < 60; ++i) {
            const Real middle = 0.5L * (low + high);
            (polynomial(t_of(low), n) * polynomial(t_of(middle), n) > 0.0L ? low : high) = middle;
        }
        nodes.push_back(static_cast<double>(low));
    }
    return nodes;
}

/// The weights on the nodes: the integrals of their Lagrange polynomials.
std::vector<double> lagrange_weights(const Measure& measure, const std::vector<double>& nodes) {
    std::vector<double> weights;
    for (const double node : nodes) {
        weights.push_back(static_cast<double>(measure.integral([&](Real t) {
            Real value = 1.0L;
            for (const double other : nodes) {
                if (other != node)
                    value *= (t - t_of(other)) / (t_of(node) - t_of(other));
            }
            return value;
        })));
    }
    return weights;
}

/// For each count the nodes of A, C1 and C2 that the rule is made of: "channel, order, index" of a Gaussian node each.
struct NodeOf {
    std::size_t channel, order, index;
};
const std::array<std::array<std::vector<NodeOf>, 3>, 4> node_sources{{
    {{{{1, 2, 0}, {0, 3, 1}, {1, 2, 1}}, {{1, 2, 0}, {1, 2, 1}}, {{2, 1, 0}}}},
    {{{{0, 2, 0}, {0, 2, 1}}, {{1, 2, 0}, {2, 2, 1}}, {{2, 2, 0}, {2, 2, 1}}}},
    {{{{2, 2, 0}, {1, 4, 1}, {0, 5, 2}, {1, 4, 2}, {1, 4, 3}},
      {{2, 2, 0}, {1, 4, 1}, {1, 4, 2}, {1, 4, 3}},
      {{2, 2, 0}, {2, 2, 1}}}},
    {{{{2, 3, 1}, {1, 4, 1}, {0, 5, 2}, {1, 4, 2}, {1, 4, 3}},
      {{2, 3, 1}, {1, 4, 1}, {1, 4, 2}, {1, 4, 3}},
      {{2, 3, 0}, {2, 3, 1}, {2, 3, 2}}}},
}};

std::vector<double> nodes_of(std::size_t row, std::size_t channel) {
    std::vector<double> nodes;
    for (const NodeOf& source : node_sources[row][channel])
        nodes.push_back(gaussian_nodes(bin_measure(source.channel), source.order).at(source.index));
    return nodes;
}

/// The rule's weight in a channel at a wavelength of it.
double weight_at(const QuadratureRule& rule, std::size_t channel, double lambda_nm) {
    for (std::size_t i = 0; i < rule.wavelengths.size(); ++i) {
        if (std::abs(rule.wavelengths[i] - lambda_nm) < 0.1)
            return opponent(channel, rule.weights[i]);
    }
    ADD_FAILURE() << "no wavelength at " << lambda_nm << " nm";
    return 0.0;
}

Xyz apply(const QuadratureRule& rule, const std::function<double(double)>& spectrum) {
    Xyz xyz{};
    for (std::size_t i = 0; i < rule.wavelengths.size(); ++i) {
        for (std::size_t channel = 0; channel < 3; ++channel)
            xyz[channel] += rule.weights[i][channel] * spectrum(rule.wavelengths[i]);
    }
    return xyz;
}

TEST(GaussRule, WavelengthsAreVisibleAndAscend) {
    for (const int count : counts) {
        const QuadratureRule rule = gauss_rule(count);
        ASSERT_EQ(rule.wavelengths.size(), static_cast<std::size_t>(count));
        ASSERT_EQ(rule.weights.size(), static_cast<std::size_t>(count));
        EXPECT_TRUE(std::is_sorted(rule.wavelengths.begin(), rule.wavelengths.end(), std::less_equal<>()));
        EXPECT_GT(rule.wavelengths.front(), lambda_min_nm);
        EXPECT_LT(rule.wavelengths.back(), lambda_max_nm);
    }
}

TEST(GaussRule, ConstantsAreExact) {
    const Xyz exact = spectrum_to_xyz(Spectrum::constant(1.0));
    for (const int count : counts) {
        const Xyz xyz = apply(gauss_rule(count), [](double) { return 1.0; });
        for (std::size_t channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(xyz[channel], exact[channel], 1e-13) << count; // sums of 400 terms, twice
    }
}

TEST(GaussRule, FourWavelengthsAreMeyers) {
    // Meyer 1988 as printed by Hall (Illumination and Color in Computer Generated Imagery, 1989), who divides the
    // weights by 1.057863 so that a constant 1 has Y = 1. C1's first weight stands at 557.7 nm in his program, but only
    // at 490.9 nm do the two integrate C1 times a linear spectrum.
    const double wavelengths[] = {456.4, 490.9, 557.7, 631.4};
    const double weights[3][4] = {
        {0.0, 0.18892, 0.67493, 0.19253}, {0.0, 0.31824, 0.0, -0.46008}, {0.54640, 0.0, 0.0, 0.0}};
    const double scale = 1.057863;

    // From a table over 380–770 nm the printed digits of the wavelengths come out. The weights may differ by 1e-4:
    // tables of his time print four decimals, so a value is off by 2.9e-5 (rms) and the sum of 79 of them over
    // ΣY = 21.4 by 1.2e-5, times 3 for the rms of A's Lagrange polynomials, times 3 standard deviations.
    const std::vector<double> a_nodes = gaussian_nodes(table_measure(0), 3);
    const std::vector<double> c1_nodes = gaussian_nodes(table_measure(1), 2);
    const std::vector<double> c2_nodes = gaussian_nodes(table_measure(2), 1);
    ASSERT_EQ(a_nodes.size(), 3u);
    ASSERT_EQ(c1_nodes.size(), 2u);
    ASSERT_EQ(c2_nodes.size(), 1u);
    const std::vector<double> shared{c1_nodes[0], a_nodes[1], c1_nodes[1]};
    EXPECT_NEAR(c2_nodes[0], wavelengths[0], 0.05);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(shared[i], wavelengths[i + 1], 0.05);
        EXPECT_NEAR(lagrange_weights(table_measure(0), shared)[i], weights[0][i + 1] / scale, 1e-4);
    }
    EXPECT_NEAR(lagrange_weights(table_measure(1), c1_nodes)[0], weights[1][1] / scale, 1e-4);
    EXPECT_NEAR(lagrange_weights(table_measure(1), c1_nodes)[1], weights[1][3] / scale, 1e-4);
    EXPECT_NEAR(lagrange_weights(table_measure(2), c2_nodes)[0], weights[2][0] / scale, 1e-4);

    // Over 380–780 nm A's middle node is 0.03 nm higher: beyond half a unit of the last digit, but within one. Its
    // neighbours' weights change by up to 0.638 / 67 nm⁻¹, 2.9e-4 for that, on top of the 1e-4 above.
    const QuadratureRule rule = gauss_rule(4);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_NEAR(rule.wavelengths[i], wavelengths[i], 0.1);
        for (std::size_t channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(opponent(channel, rule.weights[i]), weights[channel][i] / scale, 3.9e-4) << channel << ' ' << i;
    }
}

TEST(GaussRule, IsTheOraclesRule) {
    // The nodes are zeros of polynomials p from Hankel systems of condition numbers up to 1.2e4, in double precision:
    // p is good to 3e-12, and with |p'| >= 0.02 its zeros to 1.5e-10 of half the range, 3e-8 nm. The weights change by
    // at most 0.05 nm⁻¹ times that.
    for (std::size_t row = 0; row < counts.size(); ++row) {
        const QuadratureRule rule = gauss_rule(counts[row]);
        std::size_t non_zero = 0;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const std::vector<double> nodes = nodes_of(row, channel);
            const std::vector<double> weights = lagrange_weights(bin_measure(channel), nodes);
            for (std::size_t i = 0; i < nodes.size(); ++i) {
                const auto found = std::find_if(rule.wavelengths.begin(), rule.wavelengths.end(),
                                                [&](double lambda) { return std::abs(lambda - nodes[i]) < 3e-8; });
                EXPECT_NE(found, rule.wavelengths.end()) << counts[row] << ' ' << channel << ' ' << nodes[i];
                EXPECT_NEAR(weight_at(rule, channel, nodes[i]), weights[i], 2e-9);
            }
            non_zero += nodes.size();
            for (std::size_t i = 0; i < rule.weights.size(); ++i)
                non_zero -= std::abs(opponent(channel, rule.weights[i])) > 1e-12 ? 1 : 0;
        }
        EXPECT_EQ(non_zero, 0u) << counts[row]; // no channel has a weight elsewhere
    }
}

TEST(GaussRule, ChannelsAreExactToTheirDegree) {
    // 2n - 1 where a channel keeps its n Gaussian nodes, n - 1 where one has moved.
    const int degrees[4][3] = {{2, 3, 1}, {3, 1, 3}, {4, 3, 3}, {4, 3, 5}};
    for (std::size_t row = 0; row < counts.size(); ++row) {
        const QuadratureRule rule = gauss_rule(counts[row]);
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const Measure measure = bin_measure(channel);
            for (int degree = 0; degree <= degrees[row][channel] + 1; ++degree) {
                const double exact = static_cast<double>(measure.integral([&](Real t) { return std::pow(t, degree); }));
                const Xyz xyz =
                    apply(rule, [&](double lambda) { return std::pow(static_cast<double>(t_of(lambda)), degree); });
                const double error = std::abs(opponent(channel, xyz) - exact);
                if (degree <= degrees[row][channel])
                    EXPECT_LT(error, 1e-8) << counts[row] << ' ' << channel << ' ' << degree;
                else
                    EXPECT_GT(error, 1e-5) << counts[row] << ' ' << channel << ' ' << degree;
            }
        }
    }
}

TEST(GaussRule, ThreeWavelengthsAreNotDerivable) {
    // C1's single node is invisible, so C1 has two. Those, C2's one and A's one or two are all further apart than the
    // nodes that Meyer lets channels share (7.8 nm).
    EXPECT_GT(gaussian_nodes(bin_measure(1), 1).at(0), lambda_max_nm);
    for (const std::size_t a_order : {1u, 2u}) {
        std::vector<double> all = gaussian_nodes(bin_measure(0), a_order);
        for (const double node : gaussian_nodes(bin_measure(1), 2))
            all.push_back(node);
        all.push_back(gaussian_nodes(bin_measure(2), 1).at(0));
        std::sort(all.begin(), all.end());
        ASSERT_EQ(all.size(), a_order + 3);
        for (std::size_t i = 1; i < all.size(); ++i)
            EXPECT_GT(all[i] - all[i - 1], 20.0);
    }
    for (const int count : {-1, 0, 1, 3, 8, 100})
        EXPECT_THROW(gauss_rule(count), Error) << count;
}

/// The mean ΔE of smooth reflectances, the colours of a grid in [0.1, 0.9]³ of linear sRGB, under a light.
double mean_delta_e(const QuadratureRule& rule, const std::function<double(double)>& light) {
    const auto exact = [](const std::function<double(double)>& spectrum) {
        Xyz xyz{};
        for (std::size_t bin = 0; bin < lambda_bins; ++bin) {
            for (std::size_t channel = 0; channel < 3; ++channel)
                xyz[channel] += cie_bins()[channel][bin] * spectrum(lambda_min_nm + static_cast<double>(bin) + 0.5) /
                                cie_y_integral();
        }
        return xyz;
    };
    const Xyz white = exact(light);
    double sum = 0.0;
    int colours = 0;
    for (const double r : {0.1, 0.5, 0.9}) {
        for (const double g : {0.1, 0.5, 0.9}) {
            for (const double b : {0.1, 0.5, 0.9}) {
                const Spectrum reflectance = Spectrum::rgb_albedo({r, g, b});
                const auto reflected = [&](double lambda) { return reflectance(lambda) * light(lambda); };
                sum += test::delta_e_1976(test::to_lab(apply(rule, reflected), white),
                                          test::to_lab(exact(reflected), white));
                ++colours;
            }
        }
    }
    return sum / colours;
}

/// As many wavelengths in the middles of equal parts of the range, with the matching functions' integrals over the
/// parts as weights: exact for constants too.
QuadratureRule equal_parts(int count) {
    QuadratureRule rule;
    for (int i = 0; i < count; ++i) {
        rule.wavelengths.push_back(lambda_min_nm + (lambda_max_nm - lambda_min_nm) * (i + 0.5) / count);
        rule.weights.push_back({});
    }
    for (std::size_t bin = 0; bin < lambda_bins; ++bin) {
        const std::size_t part = bin * static_cast<std::size_t>(count) / lambda_bins;
        for (std::size_t channel = 0; channel < 3; ++channel)
            rule.weights[part][channel] += cie_bins()[channel][bin] / cie_y_integral();
    }
    return rule;
}

TEST(GaussRule, SmoothReflectancesAreCloserThanWithEqualParts) {
    // The finding of Meyer's paper, and why more than 4 wavelengths are offered: each further one helps. "Small" it is
    // not: 4 wavelengths have a mean ΔE of 7.6 under equal energy and 8.6 under D65, 7 have 1.9 and 3.9.
    const Spectrum d65 = Spectrum::named("stdillum-D65");
    const auto equal_energy = [](double) { return 1.0; };
    double last = INFINITY;
    double last_under_d65 = INFINITY;
    for (const int count : counts) {
        const double error = mean_delta_e(gauss_rule(count), equal_energy);
        const double under_d65 = mean_delta_e(gauss_rule(count), d65);
        RecordProperty("delta_e_" + std::to_string(count), std::to_string(error));
        RecordProperty("delta_e_d65_" + std::to_string(count), std::to_string(under_d65));
        EXPECT_LT(error, mean_delta_e(equal_parts(count), equal_energy)) << count;
        EXPECT_LT(under_d65, mean_delta_e(equal_parts(count), d65)) << count;
        EXPECT_LT(error, last) << count;
        EXPECT_LT(under_d65, last_under_d65) << count;
        last = error;
        last_under_d65 = under_d65;
    }
}

TEST(GaussRule, LineSpectraAreMissed) {
    // What makes the rule biased: no line lies at one of its wavelengths, so that lines alone are black, and of lamps
    // with lines and a continuum it sees the latter. Illuminant A is smooth: there it is right.
    const auto luminance_error = [](int count, const std::string& name) {
        const Spectrum lamp = Spectrum::named(name); // of Y = 1
        return std::abs(apply(gauss_rule(count), lamp)[1] - 1.0);
    };
    for (const int count : counts) {
        EXPECT_EQ(luminance_error(count, "illum-mercury-lines"), 1.0) << count;
        EXPECT_EQ(luminance_error(count, "illum-sodium-lines"), 1.0) << count;
        for (const std::string name : {"illum-mercury", "stdillum-F11", "stdillum-F12"})
            EXPECT_GT(luminance_error(count, name), 100.0 * luminance_error(count, "stdillum-A"))
                << count << ' ' << name;
    }
}

} // namespace
} // namespace tristim
