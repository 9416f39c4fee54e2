#include "render/error_estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>

namespace tristim {
namespace {

constexpr int window_reach = 3; // pixels
constexpr double least_batches = 4.0;
constexpr std::size_t most_levels = 3;

/// A value for each pixel.
using Plane = std::vector<double>;

int batch_bits(int level) {
    return 2 * (level + 1);
}

std::uint32_t group_of_batch(std::uint32_t batch, int level) {
    // A turn for every ERROR_GROUPS batches: lowbias32 (Wellons 2018, "Prospecting for Hash Functions").
    std::uint32_t x = batch / ERROR_GROUPS + 0x9e3779b9U * static_cast<std::uint32_t>(level + 1);
    x = (x ^ x >> 16U) * 0x7feb352dU;
    x = (x ^ x >> 15U) * 0x846ca68bU;
    return (batch + (x ^ x >> 16U)) % ERROR_GROUPS;
}

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

/// How passes fall into the groups of a level.
struct Grouping {
    std::array<double, ERROR_GROUPS> passes{};  ///< in each
    std::array<double, ERROR_GROUPS> squares{}; ///< sums of squares of the sizes of its batches
    double all_passes = 0.0;
    double all_squares = 0.0;

    /// Passes in a batch.
    double batch() const { return all_squares / all_passes; }
};

Grouping group_passes(const PassRanges& passes, int level) {
    Grouping grouping;
    const int bits = batch_bits(level);
    const auto add_batch = [&](std::uint64_t batch, double size) {
        const std::uint32_t group = group_of_batch(static_cast<std::uint32_t>(batch), level);
        grouping.passes[group] += size;
        grouping.squares[group] += size * size;
        grouping.all_passes += size;
        grouping.all_squares += size * size;
    };
    std::uint64_t batch = std::numeric_limits<std::uint64_t>::max();
    double size = 0.0;
    for (const PassRanges::Range& range : passes.ranges()) {
        for (std::uint64_t pass = range.begin; pass < range.end;) {
            const std::uint64_t end = std::min<std::uint64_t>(((pass >> bits) + 1) << bits, range.end);
            if (size > 0.0 && pass >> bits != batch) {
                add_batch(batch, size);
                size = 0.0;
            }
            batch = pass >> bits;
            size += static_cast<double>(end - pass);
            pass = end;
        }
    }
    if (size > 0.0)
        add_batch(batch, size);
    return grouping;
}

/// The variance of the mean of a batch about the mean of all passes, v(B) − v(n), of each pixel.
struct Spread {
    double batch = 1.0; ///< B
    Plane plane;
};

/// From the groups' sums S_j: with a share f_j of the passes, S_j − f_j S has the variance
/// (1 − f_j)² Σ_{k in j} b_k² V + f_j² Σ_{k not in j} b_k² V for batches of b_k passes and a variance V of their means.
Plane group_spread(const RenderSums& sums, const Grouping& grouping, int level, std::size_t channel) {
    const std::size_t pixels = sums.film.size();
    double expected = 0.0;
    for (std::size_t j = 0; j < ERROR_GROUPS; ++j) {
        const double share = grouping.passes[j] / grouping.all_passes;
        expected += (1.0 - share) * (1.0 - share) * grouping.squares[j] +
                    share * share * (grouping.all_squares - grouping.squares[j]);
    }
    Plane plane(pixels);
    const std::size_t first = 3 * static_cast<std::size_t>(level) * ERROR_GROUPS + channel;
    for (std::size_t i = 0; i < pixels; ++i) {
        std::array<double, ERROR_GROUPS> group{};
        double all = 0.0;
        for (std::size_t j = 0; j < ERROR_GROUPS; ++j)
            all += group[j] = sums.error[(first + 3 * j) * pixels + i];
        for (std::size_t j = 0; j < ERROR_GROUPS; ++j) {
            const double rest = group[j] - grouping.passes[j] / grouping.all_passes * all;
            plane[i] += rest * rest / expected;
        }
    }
    return plane;
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

/// v(n) = c n^-a from v(B) − v(n) for some B. Least squares of logarithms over a, with a weak belief in what scenes
/// showed: a = 1.3 ± 0.4.
class Extrapolation {
  public:
    Extrapolation(std::vector<double> batches, double passes) : passes_(passes) {
        const double last = batches.size() > 1 ? largest_slope : 1.0;
        for (double a = 1.0; a < last + 0.01; a += 0.1) {
            Slope slope{a, {}};
            for (const double batch : batches)
                slope.model.push_back(std::log(std::pow(batch, -a) - std::pow(passes, -a)));
            slopes_.push_back(slope);
        }
    }

    double operator()(const std::array<double, most_levels>& spreads) const {
        const std::size_t count = slopes_.front().model.size();
        std::array<double, most_levels> logs{};
        for (std::size_t l = 0; l < count; ++l) {
            // A spread of none is told from one that happens to be small by the others.
            if (!(spreads[l] > 0.0))
                return spreads[0] > 0.0 ? spreads[0] / (passes_ - 1.0) : 0.0;
            logs[l] = std::log(spreads[l]);
        }
        double least = std::numeric_limits<double>::infinity(), best = spreads[0] / (passes_ - 1.0);
        for (const Slope& slope : slopes_) {
            double mean = 0.0, squares = 0.0;
            for (std::size_t l = 0; l < count; ++l)
                mean += (logs[l] - slope.model[l]) / static_cast<double>(count);
            for (std::size_t l = 0; l < count; ++l)
                squares += (logs[l] - slope.model[l] - mean) * (logs[l] - slope.model[l] - mean);
            const double off = (slope.a - expected_slope) / slope_deviation;
            const double badness = weight * squares + off * off;
            if (badness < least) {
                least = badness;
                best = std::exp(mean - slope.a * std::log(passes_));
            }
        }
        return best;
    }

  private:
    struct Slope {
        double a;
        std::vector<double> model; ///< log(B^-a − n^-a)
    };
    static constexpr double largest_slope = 2.4, expected_slope = 1.3, slope_deviation = 0.4;
    static constexpr double weight = 6.0; ///< half of some twelve degrees of freedom of a spread over a window

    double passes_;
    std::vector<Slope> slopes_;
};

/// The variance of each pixel's mean, in one channel.
Plane noise_variance(const RenderSums& sums, int width, std::size_t channel) {
    const auto passes = static_cast<double>(sums.passes.count());
    if (passes < 2.0)
        return plain_variance(sums, channel);
    std::vector<Spread> spreads{{1.0, window_means(pass_spread(sums, channel), width)}};
    for (int level = 0; level < ERROR_LEVELS; ++level) {
        const Grouping grouping = group_passes(sums.passes, level);
        if (grouping.batch() * least_batches <= passes && grouping.batch() > spreads.back().batch)
            spreads.push_back({grouping.batch(), window_means(group_spread(sums, grouping, level, channel), width)});
    }
    if (spreads.size() > most_levels)
        spreads.erase(spreads.begin(), spreads.end() - most_levels);
    std::vector<double> batches;
    for (const Spread& spread : spreads)
        batches.push_back(spread.batch);
    const Extrapolation extrapolate(batches, passes);
    Plane variance(sums.film.size());
    for (std::size_t i = 0; i < variance.size(); ++i) {
        std::array<double, most_levels> values{};
        for (std::size_t l = 0; l < spreads.size(); ++l)
            values[l] = spreads[l].plane[i];
        variance[i] = extrapolate(values);
    }
    return variance;
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

std::uint32_t error_groups(std::uint32_t pass) {
    std::uint32_t groups = 0;
    for (int level = 0; level < ERROR_LEVELS; ++level)
        groups |= group_of_batch(pass >> batch_bits(level), level) << (level * ERROR_GROUP_BITS);
    return groups;
}

ErrorEstimate estimate_error(const RenderSums& sums, int width) {
    ErrorEstimate estimate;
    const std::size_t pixels = sums.film.size();
    estimate.complete = !sums.error.empty();
    estimate.pixel_noise.resize(estimate.complete ? pixels : 0);
    estimate.pixel_bias.resize(estimate.complete ? pixels : 0);
    double noise = 0.0, mean_y = 0.0;
    Plane squared_bias(pixels);
    for (std::size_t c = 0; c < 3; ++c) {
        if (!estimate.complete) {
            noise += mean_of(plain_variance(sums, c)) / 3.0;
            continue;
        }
        const Plane variance = noise_variance(sums, width, c);
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
