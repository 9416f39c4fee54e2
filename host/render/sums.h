#pragma once

#include "render/film.h"
#include "render/options.h"
#include "render/statistics.h"

#include <vector>

namespace tristim {

/// What passes add up to, on whatever devices.
struct RenderSums {
    std::vector<FilmPixel> film;
    RayTotals rays;
    NonFiniteCounts non_finite;
};

/// Adds the passes of another render of the same pixels, see add_film; sums without a film are none.
void add(RenderSums& sums, const RenderSums& more);

/// Whether every pixel holds as many passes; not so if a device failed while it added one.
bool holds_passes(const RenderSums& sums, std::uint64_t passes);

/// The image.
FilmImage developed(const RenderSums& sums, const RenderOptions& options);

} // namespace tristim
