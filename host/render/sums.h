#pragma once

#include "render/film.h"
#include "render/options.h"
#include "render/pass_ranges.h"
#include "render/statistics.h"

#include <vector>

namespace tristim {

/// What passes add up to, on whatever devices.
struct RenderSums {
    std::vector<FilmPixel> film;
    std::vector<float> error; ///< ERROR_PLANES planes of as many floats (shared_types.h); empty if not asked for
    PassRanges passes;        ///< that the film holds
    RayTotals rays;
    NonFiniteCounts non_finite;
    std::uint64_t photons_stored = 0;
};

/// Adds the passes of another render of the same pixels, see add_film; sums without a film are none. What errors are
/// estimated from stays only if both have it. Throws Error if some passes are in both.
void add(RenderSums& sums, const RenderSums& more);

/// Whether every pixel holds as many passes; not so if a device failed while it added one.
bool holds_passes(const std::vector<FilmPixel>& film, std::uint64_t passes);

/// The image.
FilmImage developed(const RenderSums& sums, const RenderOptions& options);

} // namespace tristim
