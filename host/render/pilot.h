#pragma once

#include "shared_types.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tristim {

/// The number of the pass that measures initial radii. It is no pass of the image, which therefore stays independent of
/// it.
inline constexpr std::uint32_t pilot_pass = 0xffffffffU;

/// An initial search radius for each pixel of an image `width` pixels wide, from one pass of visible points and
/// photons: the distance within which a visible point finds pilot_neighbours photons, measured at up to three points in
/// each of at most 24×24 tiles; a tile takes their median, kept within a factor of four of the image's median. Tiles
/// that saw no diffuse surface take the image's median. Scene units; deterministic.
std::vector<float> pilot_radii(const std::vector<VisiblePoint>& points, int width, const std::vector<Photon>& photons);
inline constexpr std::size_t pilot_neighbours = 16;

} // namespace tristim
