#pragma once

#include <Imath/ImathVec.h>

#include <array>
#include <cstdint>
#include <vector>

namespace tristim {

/// A closed triangle mesh whose vertices lie on the unit sphere and whose triangles face outward.
struct Icosphere {
    std::vector<Imath::V3d> positions;
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// An icosahedron whose triangles are split into four, `subdivisions` times: 20 · 4^subdivisions triangles.
Icosphere make_icosphere(int subdivisions);

} // namespace tristim
