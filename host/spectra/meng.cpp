// Spectra of RGB colours by J. Meng, F. Simon, J. Hanika & C. Dachsbacher, "Physically Meaningful Rendering using
// Tristimulus Colours", Computer Graphics Forum 34(4), 2015: of all spectra of the colour, the smoothest one, which
// minimises Σ (s_{i+1} − s_i)² over samples every 5 nm from 380 to 780 nm.
//
// The paper solves this for the chromaticities of a grid at X + Y + Z = 1 under equal-energy white with s ≥ 0,
// interpolates between them and scales by the brightness. Here it is solved for each colour on its own, with the XYZ of
// a reflectance under D65 as the renderer sums it, so there is no error of interpolation; and with s ≤ 1, which the
// paper leaves to a mapping of colours: without it saturated bright colours reach 1.2. With it each colour of sRGB
// still has a solution, since the XYZ of reflectances are a convex set that holds the corners of the sRGB cube.
//
// With L the Laplacian of the samples and A the 3 × 81 matrix of their XYZ, the minimum (Karush, Kuhn & Tucker) is
//   L s = Aᵀμ + λ,  A s = XYZ,  0 ≤ s ≤ 1,  λ ≥ 0 where s = 0, λ ≤ 0 where s = 1, λ = 0 elsewhere.
// The primal-dual active set method (Hintermüller, Ito & Kunisch, "The Primal-Dual Active Set Strategy as a Semismooth
// Newton Method", SIAM Journal on Optimization 13(3), 2003) guesses which samples are 0 and 1, solves for the rest, and
// guesses anew from s − λ; a guess that repeats itself is the solution.
#include "base/error.h"
#include "base/solve.h"
#include "spectra/rgb_upsampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace tristim {

namespace {

constexpr int step_nm = 5;
constexpr std::size_t samples = lambda_bins / step_nm + 1;

/// The unknowns beside the samples: the three multipliers μ and the value of one sample (see solve()).
constexpr std::size_t borders = 4;

using Samples = std::array<double, samples>;
using BorderVector = std::array<double, borders>;

/// Where a sample is held.
enum class Bound : signed char { Free, Zero, One };
using Bounds = std::array<Bound, samples>;

/// The smoothest reflectances of colours under D65.
class SmoothestReflectance {
  public:
    SmoothestReflectance() {
        const D65Colour& colour = d65_colour();
        for (std::size_t nm = 0; nm < colour.weights.size(); ++nm) {
            const std::size_t i = nm / step_nm;
            const double share = static_cast<double>(nm % step_nm) / step_nm;
            for (std::size_t channel = 0; channel < 3; ++channel) {
                const double weight = colour.weights[nm][channel] / colour.white[channel];
                weights_[channel][i] += weight * (1.0 - share);
                if (share > 0.0)
                    weights_[channel][i + 1] += weight * share;
            }
        }
    }

    Samples operator()(const Rgb& rgb) const {
        constexpr int most_guesses = 100;
        constexpr double rounding = 1e-13;
        constexpr double tolerance = 1e-9; // no solution has it if the guess left too few samples free
        const Xyz target = relative_xyz(rgb);
        Bounds bounds{};
        for (int guess = 0; guess < most_guesses; ++guess) {
            Solution solution = solve(target, bounds);
            if (update(bounds, solution) <= rounding && error(solution, target) <= tolerance) {
                for (double& value : solution.reflectance)
                    value = std::clamp(value, 0.0, 1.0);
                return solution.reflectance;
            }
        }
        fail("found no smooth reflectance of the RGB colour ({}, {}, {})", rgb[0], rgb[1], rgb[2]);
    }

  private:
    struct Solution {
        Samples reflectance{};
        Xyz multipliers{};
    };

    /// XYZ over that of the white.
    static Xyz relative_xyz(const Rgb& rgb) {
        const D65Colour& colour = d65_colour();
        Xyz xyz{};
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j)
                xyz[i] += colour.rgb_to_xyz[i][j] * rgb[j] / colour.white[i];
        }
        return xyz;
    }

    /// The minimum with samples held at their bounds and the others unbounded.
    ///
    /// L alone is singular if no sample is held, since it does not see constants. So the equation of one sample, k, is
    /// written (L s)_k + s_k = (Aᵀμ)_k + ν with the further unknown ν = s_k. What is left without the borders, (μ, ν),
    /// is tridiagonal, positive definite and solved for the right side and for each border at once.
    Solution solve(const Xyz& target, const Bounds& bounds) const {
        constexpr std::size_t k = samples / 2;
        // Columns: the borders, then the right side. The elimination (Thomas) leaves 1 on the diagonal.
        std::array<std::array<double, borders + 1>, samples> columns{};
        Samples upper{};
        for (std::size_t i = 0; i < samples; ++i) {
            const bool first = i == 0;
            const bool last = i == samples - 1;
            if (bounds[i] != Bound::Free) {
                columns[i][borders] = bounds[i] == Bound::One ? 1.0 : 0.0;
                continue;
            }
            for (std::size_t channel = 0; channel < 3; ++channel)
                columns[i][channel] = weights_[channel][i];
            columns[i][3] = i == k ? 1.0 : 0.0;
            const double diagonal = (first || last ? 1.0 : 2.0) + columns[i][3];
            const double pivot = first ? diagonal : diagonal + upper[i - 1];
            upper[i] = last ? 0.0 : -1.0 / pivot;
            for (std::size_t j = 0; j <= borders; ++j)
                columns[i][j] = (columns[i][j] + (first ? 0.0 : columns[i - 1][j])) / pivot;
        }
        for (std::size_t i = samples - 1; i-- > 0;) {
            for (std::size_t j = 0; j <= borders; ++j)
                columns[i][j] -= upper[i] * columns[i + 1][j];
        }
        // The borders' own equations: A s = XYZ, and ν = s_k if that sample is free, else ν = 0.
        std::array<BorderVector, borders> equations{};
        BorderVector right{};
        for (std::size_t channel = 0; channel < 3; ++channel) {
            right[channel] = target[channel];
            for (std::size_t i = 0; i < samples; ++i) {
                for (std::size_t j = 0; j < borders; ++j)
                    equations[channel][j] += weights_[channel][i] * columns[i][j];
                right[channel] -= weights_[channel][i] * columns[i][borders];
            }
        }
        if (bounds[k] == Bound::Free) {
            for (std::size_t j = 0; j < borders; ++j)
                equations[3][j] = columns[k][j];
            right[3] = -columns[k][borders];
        }
        equations[3][3] -= 1.0;
        const BorderVector border = tristim::solve(equations, right);
        Solution solution;
        for (std::size_t i = 0; i < samples; ++i) {
            solution.reflectance[i] = columns[i][borders];
            for (std::size_t j = 0; j < borders; ++j)
                solution.reflectance[i] += columns[i][j] * border[j];
        }
        std::copy_n(border.begin(), 3, solution.multipliers.begin());
        return solution;
    }

    /// The sum of deviations from the colour's XYZ over that of the white; NaN if the solution is.
    double error(const Solution& solution, const Xyz& target) const {
        double error = 0.0;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const auto& weights = weights_[channel];
            const auto& s = solution.reflectance;
            error += std::abs(std::inner_product(s.begin(), s.end(), weights.begin(), -target[channel]));
        }
        return error;
    }

    /// λ of a held sample.
    double bound_multiplier(const Solution& solution, std::size_t i) const {
        const Samples& s = solution.reflectance;
        double multiplier = 0.0;
        if (i > 0)
            multiplier += s[i] - s[i - 1];
        if (i + 1 < samples)
            multiplier += s[i] - s[i + 1];
        for (std::size_t channel = 0; channel < 3; ++channel)
            multiplier -= weights_[channel][i] * solution.multipliers[channel];
        return multiplier;
    }

    /// Guesses the bounds anew; returns the largest violation of a condition, 0 if the guess is the old one.
    double update(Bounds& bounds, const Solution& solution) const {
        double violation = 0.0;
        for (std::size_t i = 0; i < samples; ++i) {
            const double multiplier = bounds[i] == Bound::Free ? 0.0 : bound_multiplier(solution, i);
            const double value = solution.reflectance[i];
            Bound bound = Bound::Free;
            if (value - multiplier < 0.0)
                bound = Bound::Zero;
            else if (value - multiplier > 1.0)
                bound = Bound::One;
            if (bound == bounds[i])
                continue;
            violation = std::max({violation, std::abs(multiplier), -value, value - 1.0});
            bounds[i] = bound;
        }
        return violation;
    }

    std::array<Samples, 3> weights_{}; // A: XYZ, over that of the white, of the sample 1 among zeros
};

} // namespace

Spectrum meng_reflectance(const Rgb& rgb) {
    static const SmoothestReflectance smoothest;
    const Samples reflectance = smoothest(rgb);
    std::vector<double> lambda_nm;
    std::vector<double> values;
    // Beyond the samples the smoothest continuation is constant.
    for (int lambda = 360; lambda <= 830; ++lambda) {
        const double at = std::clamp(lambda - lambda_min_nm, 0.0, static_cast<double>(lambda_bins)) / step_nm;
        const std::size_t i = std::min(static_cast<std::size_t>(at), samples - 2);
        lambda_nm.push_back(lambda);
        values.push_back(std::lerp(reflectance[i], reflectance[i + 1], at - static_cast<double>(i)));
    }
    return Spectrum::piecewise_linear(std::move(lambda_nm), std::move(values));
}

} // namespace tristim
