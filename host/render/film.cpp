#include "render/film.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace tristim {
namespace {

/// A sum of 106 bits, as two doubles that do not overlap.
struct WideSum {
    double high = 0.0, low = 0.0;

    /// By Knuth's TwoSum (1997, TAOCP vol. 2, section 4.2.2, theorem B).
    void add(double value) {
        const double sum = high + value;
        const double part = sum - high;
        low += (high - (sum - part)) + (value - part);
        high = sum;
    }
};

/// Adds one sum of floats, the largest first, to another.
template <std::size_t N>
void add_sum(const std::array<float*, N>& sum, const std::array<float, N>& more) {
    WideSum wide;
    for (std::size_t i = N; i-- > 0;) {
        wide.add(*sum[i]);
        wide.add(more[i]);
    }
    double rest = wide.high;
    for (float* part : sum) {
        *part = static_cast<float>(rest + wide.low);
        rest -= *part;
    }
}

std::uint64_t long_count(std::uint32_t low, std::uint32_t carries) {
    return std::uint64_t{low} | std::uint64_t{carries} << 32U;
}

} // namespace

std::array<double, 3> sample_sums(const FilmPixel& pixel) {
    std::array<double, 3> sums{};
    for (std::size_t c = 0; c < 3; ++c)
        sums[c] = double{pixel.sum_high[c]} + (double{pixel.sum_middle[c]} + pixel.sum_low[c]);
    return sums;
}

std::array<double, 3> square_sums(const FilmPixel& pixel) {
    std::array<double, 3> sums{};
    for (std::size_t c = 0; c < 3; ++c)
        sums[c] = double{pixel.square_high[c]} + pixel.square_low[c];
    return sums;
}

std::uint64_t camera_rays(const FilmPixel& pixel) {
    return long_count(pixel.camera_rays, pixel.ray_carries & 0xffffU);
}

std::uint64_t shadow_rays(const FilmPixel& pixel) {
    return long_count(pixel.shadow_rays, pixel.ray_carries >> 16U);
}

void add_film(std::span<FilmPixel> film, std::span<const FilmPixel> more) {
    for (std::size_t i = 0; i < film.size(); ++i) {
        FilmPixel& a = film[i];
        const FilmPixel& b = more[i];
        for (std::size_t c = 0; c < 3; ++c) {
            add_sum<3>({&a.sum_high[c], &a.sum_middle[c], &a.sum_low[c]},
                       {b.sum_high[c], b.sum_middle[c], b.sum_low[c]});
            if (std::isinf(a.square_high[c]) || std::isinf(b.square_high[c])) {
                a.square_high[c] = std::numeric_limits<float>::infinity();
                a.square_low[c] = 0.0F;
            } else {
                add_sum<2>({&a.square_high[c], &a.square_low[c]}, {b.square_high[c], b.square_low[c]});
            }
        }
        a.samples += b.samples;
        a.rejected += b.rejected;
        const std::uint64_t camera = camera_rays(a) + camera_rays(b), shadow = shadow_rays(a) + shadow_rays(b);
        a.camera_rays = static_cast<std::uint32_t>(camera);
        a.shadow_rays = static_cast<std::uint32_t>(shadow);
        a.ray_carries = static_cast<std::uint32_t>(camera >> 32U) | static_cast<std::uint32_t>(shadow >> 32U) << 16U;
    }
}

XyzImage xyz_image(FilmImage film) {
    return {film.full_width, film.full_height, film.region, std::move(film.xyz)};
}

FilmImage develop_film(const std::vector<FilmPixel>& pixels, int full_width, int full_height, const Region& region) {
    FilmImage image{full_width, full_height, region, {}, {}, 0, 0};
    image.xyz.resize(pixels.size());
    image.variance.resize(pixels.size());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const FilmPixel& pixel = pixels[i];
        image.rejected_samples += pixel.rejected;
        image.passes = std::max<std::uint64_t>(image.passes, std::uint64_t{pixel.samples} + pixel.rejected);
        const double n = pixel.samples;
        if (pixel.samples == 0)
            continue;
        const std::array<double, 3> sums = sample_sums(pixel), squares = square_sums(pixel);
        for (std::size_t c = 0; c < 3; ++c) {
            const double mean = sums[c] / n;
            const double square = squares[c] / n;
            image.xyz[i][c] = static_cast<float>(mean);
            if (pixel.samples > 1)
                image.variance[i][c] = static_cast<float>(std::max(square - mean * mean, 0.0) / (n - 1.0));
        }
    }
    return image;
}

FilmImage merge(const FilmImage& a, const FilmImage& b) {
    if (a.passes == 0 || b.passes == 0)
        return a.passes == 0 ? b : a;
    FilmImage both = a;
    both.rejected_samples += b.rejected_samples;
    both.passes += b.passes;
    const auto m = static_cast<double>(a.passes);
    const auto n = static_cast<double>(b.passes);
    const double total = m + n;
    for (std::size_t i = 0; i < both.xyz.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double difference = static_cast<double>(b.xyz[i][c]) - a.xyz[i][c];
            // A variance of the mean times n (n − 1) is the sum of squares about the mean.
            const double squares = a.variance[i][c] * m * (m - 1.0) + b.variance[i][c] * n * (n - 1.0) +
                                   difference * difference * m * n / total;
            both.xyz[i][c] = static_cast<float>(a.xyz[i][c] + difference * n / total);
            both.variance[i][c] = static_cast<float>(squares / (total * (total - 1.0)));
        }
    }
    return both;
}

} // namespace tristim
