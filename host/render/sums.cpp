#include "render/sums.h"

#include <algorithm>
#include <functional>

namespace tristim {

void add(RenderSums& sums, const RenderSums& more) {
    if (more.film.empty())
        return;
    if (sums.film.empty()) {
        sums = more;
        return;
    }
    sums.passes.add(more.passes);
    add_film(sums.film, more.film);
    if (sums.error.size() == more.error.size())
        std::transform(sums.error.begin(), sums.error.end(), more.error.begin(), sums.error.begin(), std::plus<>());
    else
        sums.error.clear();
    sums.photons_stored += more.photons_stored;
    sums.rays.camera += more.rays.camera;
    sums.rays.shadow += more.rays.shadow;
    sums.rays.photon += more.rays.photon;
    sums.non_finite.eye += more.non_finite.eye;
    sums.non_finite.photon += more.non_finite.photon;
    sums.non_finite.gather += more.non_finite.gather;
    sums.non_finite.film += more.non_finite.film;
}

bool holds_passes(const std::vector<FilmPixel>& film, std::uint64_t passes) {
    return std::all_of(film.begin(), film.end(), [passes](const FilmPixel& pixel) {
        return std::uint64_t{pixel.samples} + pixel.rejected == passes;
    });
}

FilmImage developed(const RenderSums& sums, const RenderOptions& options) {
    FilmImage image = develop_film(sums.film, options.width, options.height, options.region);
    image.rejected_samples = sums.non_finite.total();
    return image;
}

} // namespace tristim
