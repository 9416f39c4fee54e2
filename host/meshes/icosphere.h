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

/// An icosphere with pbrt's coordinates of a sphere: u = φ/2π, v = 1 − θ/π with spherical angles about z. It is turned
/// so that edges run along the half-plane φ = 0. Vertices there are double, with u = 0 and u = 1, and the poles have
/// one vertex for each triangle, whose u is in the middle of the triangle's others.
struct UvSphere {
    std::vector<Imath::V3d> positions;
    std::vector<Imath::V2f> uv;
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// `subdivisions` ≥ 1, as for make_icosphere().
UvSphere make_uv_sphere(int subdivisions);

} // namespace tristim
