#include "render/film.h"

#include <algorithm>
#include <utility>

namespace tristim {

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
        for (std::size_t c = 0; c < 3; ++c) {
            const double mean = (static_cast<double>(pixel.sum_high[c]) + pixel.sum_low[c]) / n;
            const double square = (static_cast<double>(pixel.square_high[c]) + pixel.square_low[c]) / n;
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
