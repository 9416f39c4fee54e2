#pragma once

#include <Imath/ImathVec.h>

#include <array>
#include <cstddef>
#include <vector>

namespace tristim {

/// Cuts a simple, roughly planar polygon, convex or not, into corners.size() − 2 triangles of the same orientation by
/// clipping ears. The triangles index into `corners`.
std::vector<std::array<std::size_t, 3>> triangulate(const std::vector<Imath::V3f>& corners);

} // namespace tristim
