// Meyer's construction (1988). Each channel A, C1, C2 of the opponent space is an integral of the spectrum with a
// weight function of its own, the channel's matching function, and gets the nodes of an n-point Gaussian quadrature for
// it. A has the highest order since it carries most of the variance of natural spectra, then C1, then C2. Then nodes of
// different channels that lie close become one: the channel of the higher order, which loses least, takes the other's
// node. A channel's weights make the rule on its own nodes exact for polynomials of degree n - 1 (2n - 1 where none of
// its nodes has moved), and the inverse of the opponent matrix turns them into weights of X, Y and Z.
//
// Meyer's 4 wavelengths are the orders 3, 2, 1:
//   A   483.1, 557.8, 632.3 nm -> 490.9, 557.8, 631.4 nm
//   C1  490.9, 631.4 nm
//   C2  456.4 nm
// This was read off the rule as Hall prints it ("Illumination and Color in Computer Generated Imagery", 1989), 456.4,
// 490.9, 557.7 and 631.4 nm, and reproduces it: A's middle node is 557.73 nm by tables over 380–770 nm and 557.76 over
// the renderer's 380–780. The printed weights are 1.0579 times those here, and so are the X, Y and Z that they give to
// a constant spectrum 1; Hall divides by 1.057863.
//
// C1 and C2 change sign, so that their Gaussian nodes need not be real or visible. They are for the even orders of C1
// and for the orders 1, 2, 3 of C2, which is all that is used here; C1's single node would lie at 947 nm. Hence there
// is no rule of 3 wavelengths: two of C1, one of C2 and those of A lie too far apart for that. The orders of 5 to 7
// wavelengths are, of all n_A >= n_C1 >= n_C2 that give this count, those with the least error for smooth reflectances;
// more wavelengths gain little. The tests note the mean ΔE of each rule.

#include "spectra/gauss_rule.h"

#include "base/error.h"
#include "base/solve.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace tristim {

namespace {

constexpr std::size_t channels = 3; // A, C1, C2

/// AC1C2 from XYZ (Meyer 1988, as in Hall 1989).
constexpr Matrix3 xyz_to_opponent{{{-0.0177, 1.0090, 0.0073}, {-1.5370, 1.0821, 0.3209}, {0.1946, -0.2045, 0.5264}}};

/// Nodes of two channels closer than this are one. Meyer's 4 wavelengths move one by 8 nm.
constexpr double shared_node_distance_nm = 10.0;

/// The orders of A, C1 and C2 for gauss_wavelengths_min, … wavelengths.
constexpr std::array<std::array<std::size_t, channels>, 4> orders{{{3, 2, 1}, {2, 2, 2}, {5, 4, 2}, {5, 4, 3}}};
static_assert(orders.size() == gauss_wavelengths_max - gauss_wavelengths_min + 1);

/// The visible range is [-1, 1] of this variable, which keeps powers of it and the systems below well scaled.
double scaled(double lambda_nm) {
    return (2.0 * lambda_nm - lambda_min_nm - lambda_max_nm) / (lambda_max_nm - lambda_min_nm);
}

using Matrix = std::vector<std::vector<double>>;

/// The first moments (1/k) ∫ scaled(λ)^i f(λ) dλ of a channel's matching function, which is constant in each bin.
std::vector<double> moments(std::size_t channel, std::size_t count) {
    std::vector<double> result(count);
    for (std::size_t bin = 0; bin < lambda_bins; ++bin) {
        double f = 0.0;
        for (std::size_t j = 0; j < 3; ++j)
            f += xyz_to_opponent[channel][j] * cie_bins()[j][bin];
        const double low = scaled(lambda_min_nm + static_cast<double>(bin));
        const double high = scaled(lambda_min_nm + static_cast<double>(bin + 1));
        double low_power = 1.0;
        double high_power = 1.0;
        for (std::size_t i = 0; i < count; ++i) {
            low_power *= low;
            high_power *= high;
            const double mean = (high_power - low_power) / ((high - low) * static_cast<double>(i + 1));
            result[i] += f * mean / cie_y_integral();
        }
    }
    return result;
}

/// The monic polynomial t^n + Σ c_i t^i at scaled(λ), by Horner's rule.
double monic(const std::vector<double>& c, double lambda_nm) {
    const double t = scaled(lambda_nm);
    double value = 1.0;
    for (std::size_t i = c.size(); i-- > 0;)
        value = value * t + c[i];
    return value;
}

/// The nodes in nm of a channel's n-point Gaussian quadrature: the zeros of the polynomial of degree n that is
/// orthogonal, with the channel's matching function as the weight, to all of lower degree. The caller knows that they
/// are real and visible; they are more than 1 nm apart.
std::vector<double> gaussian_nodes(std::size_t channel, std::size_t n) {
    const std::vector<double> m = moments(channel, 2 * n);
    Matrix hankel(n, std::vector<double>(n));
    std::vector<double> right(n);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j)
            hankel[i][j] = m[i + j];
        right[i] = -m[i + n];
    }
    const std::vector<double> polynomial = solve(std::move(hankel), std::move(right));
    std::vector<double> nodes;
    for (double from = lambda_min_nm; from < lambda_max_nm; from += 1.0) {
        double low = from;
        double high = from + 1.0;
        const bool low_is_negative = monic(polynomial, low) < 0.0;
        if (low_is_negative == (monic(polynomial, high) < 0.0))
            continue;
        for (double middle = 0.5 * (low + high); middle > low && middle < high; middle = 0.5 * (low + high))
            ((monic(polynomial, middle) < 0.0) == low_is_negative ? low : high) = middle;
        nodes.push_back(low);
    }
    return nodes;
}

/// The weights on the given nodes that integrate a channel exactly for polynomials of lower degree than their count.
std::vector<double> interpolatory_weights(std::size_t channel, const std::vector<double>& nodes) {
    Matrix vandermonde(nodes.size(), std::vector<double>(nodes.size(), 1.0));
    for (std::size_t i = 1; i < nodes.size(); ++i) {
        for (std::size_t j = 0; j < nodes.size(); ++j)
            vandermonde[i][j] = vandermonde[i - 1][j] * scaled(nodes[j]);
    }
    return solve(std::move(vandermonde), moments(channel, nodes.size()));
}

/// The one of `nodes` that is nearest to `lambda_nm`, if it is close enough to be shared.
std::optional<double> close_node(const std::vector<double>& nodes, double lambda_nm) {
    std::optional<double> nearest;
    for (const double node : nodes) {
        if (std::abs(node - lambda_nm) < std::abs(nearest.value_or(lambda_nm + shared_node_distance_nm) - lambda_nm))
            nearest = node;
    }
    return nearest;
}

} // namespace

QuadratureRule gauss_rule(int wavelengths) {
    if (wavelengths < gauss_wavelengths_min || wavelengths > gauss_wavelengths_max)
        fail("Gaussian quadrature in the opponent space gives rules of {} to {} wavelengths, not of {}.",
             gauss_wavelengths_min, gauss_wavelengths_max, wavelengths);
    const auto& order = orders[static_cast<std::size_t>(wavelengths - gauss_wavelengths_min)];

    QuadratureRule rule;
    std::array<std::vector<double>, channels> nodes;
    for (std::size_t channel = channels; channel-- > 0;) {
        for (const double node : gaussian_nodes(channel, order[channel]))
            nodes[channel].push_back(close_node(rule.wavelengths, node).value_or(node));
        for (const double node : nodes[channel]) {
            if (std::find(rule.wavelengths.begin(), rule.wavelengths.end(), node) == rule.wavelengths.end())
                rule.wavelengths.push_back(node);
        }
    }
    std::sort(rule.wavelengths.begin(), rule.wavelengths.end());

    std::vector<std::array<double, channels>> opponent(rule.wavelengths.size());
    for (std::size_t channel = 0; channel < channels; ++channel) {
        const std::vector<double> weights = interpolatory_weights(channel, nodes[channel]);
        for (std::size_t i = 0; i < weights.size(); ++i) {
            const auto found = std::find(rule.wavelengths.begin(), rule.wavelengths.end(), nodes[channel][i]);
            opponent[static_cast<std::size_t>(found - rule.wavelengths.begin())][channel] = weights[i];
        }
    }
    Matrix to_opponent;
    for (const auto& row : xyz_to_opponent)
        to_opponent.emplace_back(row.begin(), row.end());
    for (const auto& weights : opponent) {
        const std::vector<double> xyz = solve(to_opponent, std::vector<double>(weights.begin(), weights.end()));
        rule.weights.push_back({xyz[0], xyz[1], xyz[2]});
    }
    return rule;
}

} // namespace tristim
