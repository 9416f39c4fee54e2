#include "render/film.h"

#include <algorithm>

namespace tristim {

FilmImage develop_film(const std::vector<FilmPixel>& pixels, int full_width, int full_height, const Region& region) {
    FilmImage image{full_width, full_height, region, {}, {}, 0};
    image.xyz.resize(pixels.size());
    image.variance.resize(pixels.size());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const FilmPixel& pixel = pixels[i];
        image.rejected_samples += pixel.rejected;
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

} // namespace tristim
