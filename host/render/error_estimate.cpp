#include "render/error_estimate.h"

#include "render/error_contrasts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tristim {
namespace {

constexpr int window_reach = 3; // pixels

/// A value for each pixel.
using Plane = std::vector<double>;

/// Means over the pixels within window_reach in x and in y.
Plane window_means(const Plane& plane, int width) {
    const int height = static_cast<int>(plane.size()) / width;
    const auto along = [&](const Plane& from, int length, int lines, int step, int line_step) {
        Plane sums(from.size());
        for (int line = 0; line < lines; ++line) {
            for (int i = 0; i < length; ++i) {
                const int first = std::max(i - window_reach, 0), last = std::min(i + window_reach, length - 1);
                double sum = 0.0;
                for (int k = first; k <= last; ++k)
                    sum += from[static_cast<std::size_t>(line * line_step + k * step)];
                sums[static_cast<std::size_t>(line * line_step + i * step)] = sum / (last - first + 1);
            }
        }
        return sums;
    };
    return along(along(plane, width, height, 1, width), height, width, width, 1);
}

/// The variance of single passes about their mean.
Plane pass_spread(const RenderSums& sums, std::size_t channel) {
    Plane plane(sums.film.size());
    for (std::size_t i = 0; i < plane.size(); ++i) {
        const double n = std::max(1.0, static_cast<double>(sums.film[i].samples));
        const double mean = sample_sums(sums.film[i])[channel] / n;
        plane[i] = std::max(square_sums(sums.film[i])[channel] / n - mean * mean, 0.0);
    }
    return plane;
}

/// The variance that the mean would have if passes were independent; infinite after one.
Plane plain_variance(const RenderSums& sums, std::size_t channel) {
    const auto passes = static_cast<double>(sums.passes.count());
    if (passes < 2.0)
        return Plane(sums.film.size(), std::numeric_limits<double>::infinity());
    Plane plane = pass_spread(sums, channel);
    for (double& value : plane)
        value /= passes - 1.0;
    return plane;
}

/// The sum of the squares of a set of contrasts, of each pixel.
Plane contrast_squares(const RenderSums& sums, const ContrastSet& set, std::size_t channel) {
    const std::size_t pixels = sums.film.size();
    const std::size_t first = 3 * static_cast<std::size_t>(set.level) * ERROR_GROUPS + channel;
    Plane plane(pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
        std::array<double, ERROR_GROUPS> groups{};
        double all = 0.0;
        for (std::size_t g = 0; g < ERROR_GROUPS; ++g)
            all += groups[g] = sums.error[(first + 3 * g) * pixels + i];
        for (const ErrorContrast& contrast : set.contrasts) {
            double value = -contrast.share * all;
            for (std::size_t g = 0; g < ERROR_GROUPS; ++g)
                value += contrast.factors[g] * groups[g];
            plane[i] += value * value;
        }
    }
    return plane;
}

/// Squares of each pixel whose sum tells of the noise.
struct Evidence {
    BlockSquares squares{};
    double batch = 1.0; ///< passes of the blocks that it compares
    double freedom = 0.0;
    std::vector<Plane> planes; ///< X, Y, Z; means over windows
};

std::vector<Evidence> evidence(const RenderSums& sums, int width) {
    std::vector<Evidence> result(1);
    const auto passes = static_cast<double>(sums.passes.count());
    // Σ (x_i − mean)² over the passes.
    result[0].squares = block_squares(sums.passes);
    for (double& square : result[0].squares)
        square = passes - square / passes;
    result[0].freedom = passes - 1.0;
    for (std::size_t c = 0; c < 3; ++c) {
        Plane plane = pass_spread(sums, c);
        for (double& value : plane)
            value *= passes;
        result[0].planes.push_back(window_means(plane, width));
    }
    for (const ContrastSet& set : error_contrasts(sums.passes)) {
        result.push_back({set.squares, set.batch, set.freedom, {}});
        for (std::size_t c = 0; c < 3; ++c)
            result.back().planes.push_back(window_means(contrast_squares(sums, set, c), width));
    }
    return result;
}

/// The variance of the mean of all passes by a mixture of two powers of n, from sums of squares. For each of some
/// shares of the two their size follows, and a likelihood, as if the squares were of independent Gaussian numbers (so
/// that they have gamma distributions); the mean over the shares, weighted by likelihood, is taken.
class Extrapolation {
  public:
    Extrapolation(const std::vector<Evidence>& evidence, const PassRanges& passes) {
        const auto coarsest = std::max_element(evidence.begin(), evidence.end(),
                                               [](const auto& a, const auto& b) { return a.batch < b.batch; });
        const auto n = static_cast<double>(passes.count());
        const BlockSquares all = block_squares(passes);
        for (const Evidence& e : evidence) {
            weights_.push_back(std::min(e.freedom, most_freedom) * e.batch / coarsest->batch);
            all_weights_ += weights_.back();
        }
        // Without blocks to compare, the plain spread is told.
        const int last = evidence.size() > 1 ? shares : 0;
        for (int i = 0; i <= last; ++i) {
            const double fast = static_cast<double>(i) / shares;
            const auto mixed = [&](const BlockSquares& squares) {
                return (1.0 - fast) * variance_by_power(squares, slow_power) /
                           variance_by_power(coarsest->squares, slow_power) +
                       fast * variance_by_power(squares, fast_power) / variance_by_power(coarsest->squares, fast_power);
            };
            Mixture mixture;
            for (std::size_t e = 0; e < evidence.size(); ++e) {
                const double expected = mixed(evidence[e].squares);
                mixture.factors.push_back(weights_[e] / expected / all_weights_);
                mixture.likelihood -= pixels_of_window * weights_[e] * std::log(expected);
            }
            mixture.variance = mixed(all) / (n * n);
            mixtures_.push_back(mixture);
        }
    }

    double operator()(const std::vector<Evidence>& evidence, std::size_t channel, std::size_t pixel) const {
        std::array<double, shares + 1> sizes{}, likelihoods{};
        double most = -std::numeric_limits<double>::infinity();
        for (std::size_t m = 0; m < mixtures_.size(); ++m) {
            for (std::size_t e = 0; e < evidence.size(); ++e)
                sizes[m] += mixtures_[m].factors[e] * evidence[e].planes[channel][pixel];
            if (!(sizes[m] > 0.0))
                return 0.0;
            likelihoods[m] = mixtures_[m].likelihood - pixels_of_window * all_weights_ * std::log(sizes[m]);
            most = std::max(most, likelihoods[m]);
        }
        double sum = 0.0, weights = 0.0;
        for (std::size_t m = 0; m < mixtures_.size(); ++m) {
            const double weight = std::exp(likelihoods[m] - most);
            sum += weight * sizes[m] * mixtures_[m].variance;
            weights += weight;
        }
        return sum / weights;
    }

  private:
    struct Mixture {
        std::vector<double> factors; ///< by which evidence adds up to the size
        double likelihood = 0.0;     ///< its logarithm, less what depends on the size
        double variance = 0.0;       ///< of the mean, for a size of 1
    };
    // Passes that nothing orders against each other; and what lies between an edge in two stratified dimensions, n^-3/2
    // (Mitchell 1996, "Consequences of Stratified Sampling in Graphics"), and a smooth function of one, n^-2.
    static constexpr double slow_power = 1.0, fast_power = 1.75;
    static constexpr int shares = 12;
    // More tell no more: from one size of blocks to the next, sequences do not follow powers.
    static constexpr double most_freedom = 4.0;
    static constexpr double pixels_of_window = 0.5 * (2 * window_reach + 1) * (2 * window_reach + 1);

    std::vector<double> weights_;
    double all_weights_ = 0.0;
    std::vector<Mixture> mixtures_;
};

/// The variance of each pixel's mean, in X, Y and Z.
std::array<Plane, 3> noise_variances(const RenderSums& sums, int width) {
    if (sums.passes.count() < 2)
        return {plain_variance(sums, 0), plain_variance(sums, 1), plain_variance(sums, 2)};
    const std::vector<Evidence> known = evidence(sums, width);
    const Extrapolation extrapolate(known, sums.passes);
    std::array<Plane, 3> variances;
    for (std::size_t c = 0; c < 3; ++c) {
        variances[c].resize(sums.film.size());
        for (std::size_t i = 0; i < sums.film.size(); ++i)
            variances[c][i] = extrapolate(known, c, i);
    }
    return variances;
}

/// The bias of a channel and the variance of that estimate.
struct BiasPlanes {
    Plane mean, variance;
};

BiasPlanes bias_planes(const RenderSums& sums, std::size_t channel) {
    const std::size_t pixels = sums.film.size();
    BiasPlanes bias{Plane(pixels), Plane(pixels)};
    for (std::size_t i = 0; i < pixels; ++i) {
        const double n = std::max(1.0, static_cast<double>(sums.film[i].samples));
        const double mean = double{sums.error[(ERROR_BIAS_PLANE + channel) * pixels + i]} / n;
        const double square = double{sums.error[(ERROR_BIAS_PLANE + 3 + channel) * pixels + i]} / n;
        bias.mean[i] = mean;
        bias.variance[i] = std::max(square - mean * mean, 0.0) / std::max(n - 1.0, 1.0);
    }
    return bias;
}

double mean_of(const Plane& plane) {
    double sum = 0.0;
    for (const double value : plane)
        sum += value;
    return sum / static_cast<double>(plane.size());
}

/// The mean of squares from which noise was taken off, less what the noise left: by its spread over tiles of the image,
/// among which little noise is shared, as far as it is smaller than itself; else nothing.
double significant_mean(const Plane& plane, int width) {
    const int tile = 2 * window_reach + 1;
    const int tiles = (width + tile - 1) / tile;
    const int height = static_cast<int>(plane.size()) / width;
    Plane sums(static_cast<std::size_t>(tiles * ((height + tile - 1) / tile)));
    for (std::size_t i = 0; i < plane.size(); ++i) {
        const int x = static_cast<int>(i) % width, y = static_cast<int>(i) / width;
        sums[static_cast<std::size_t>(y / tile * tiles + x / tile)] += plane[i];
    }
    double sum = 0.0, squares = 0.0;
    for (const double part : sums) {
        sum += part;
        squares += part * part;
    }
    return sum > 0.0 ? sum / static_cast<double>(plane.size()) * std::max(1.0 - squares / (sum * sum), 0.0) : 0.0;
}

} // namespace

ErrorEstimate estimate_error(const RenderSums& sums, int width) {
    ErrorEstimate estimate;
    const std::size_t pixels = sums.film.size();
    estimate.complete = !sums.error.empty();
    estimate.pixel_noise.resize(estimate.complete ? pixels : 0);
    estimate.pixel_bias.resize(estimate.complete ? pixels : 0);
    double noise = 0.0, mean_y = 0.0;
    Plane squared_bias(pixels);
    std::array<Plane, 3> variances;
    if (estimate.complete)
        variances = noise_variances(sums, width);
    for (std::size_t c = 0; c < 3; ++c) {
        if (!estimate.complete) {
            noise += mean_of(plain_variance(sums, c)) / 3.0;
            continue;
        }
        const Plane& variance = variances[c];
        noise += mean_of(variance) / 3.0;
        for (std::size_t i = 0; i < pixels; ++i)
            estimate.pixel_noise[i][c] = static_cast<float>(std::sqrt(variance[i]));
        const BiasPlanes planes = bias_planes(sums, c);
        Plane squares(pixels);
        for (std::size_t i = 0; i < pixels; ++i)
            squares[i] = planes.mean[i] * planes.mean[i];
        for (std::size_t i = 0; i < pixels; ++i)
            squared_bias[i] += (squares[i] - planes.variance[i]) / 3.0;
        const Plane square = window_means(squares, width), error = window_means(planes.variance, width);
        for (std::size_t i = 0; i < pixels; ++i) {
            const double share = square[i] > 0.0 ? std::max(1.0 - error[i] / square[i], 0.0) : 0.0;
            estimate.pixel_bias[i][c] = static_cast<float>(share * planes.mean[i]);
        }
    }
    for (const FilmPixel& pixel : sums.film)
        mean_y += sample_sums(pixel)[1] / std::max(1.0, static_cast<double>(pixel.samples));
    mean_y /= static_cast<double>(pixels);
    const auto relative = [mean_y](double mean_square) {
        return mean_square > 0.0 ? std::sqrt(mean_square) / mean_y : 0.0; // also of a black image
    };
    estimate.noise = relative(noise);
    estimate.bias = relative(significant_mean(squared_bias, width));
    estimate.rmse = std::hypot(estimate.noise, estimate.bias);
    return estimate;
}

std::string describe(const ErrorEstimate& estimate) {
    if (!std::isfinite(estimate.rmse))
        return "noise unknown";
    if (!estimate.complete)
        return fmt::format("noise at most {:.2g}", estimate.noise);
    return fmt::format("estimated RMSE {:.2g} (noise {:.2g}, bias {:.2g})", estimate.rmse, estimate.noise,
                       estimate.bias);
}

} // namespace tristim
