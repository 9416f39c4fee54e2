#pragma once

#include "scene/scene.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tristim {

/// A mesh in double precision while transforms are applied.
struct Geometry {
    std::vector<V3d> positions;
    std::vector<V3d> normals; ///< empty or one per position; need not be unit
    std::vector<V2f> uv;      ///< empty or one per position
    std::vector<std::array<std::uint32_t, 3>> triangles;
    /// Which pbrt shape each triangle belongs to: pbrt makes one light of each triangle or bilinear patch, and "power"
    /// is meant for each of them.
    std::vector<std::uint32_t> patches;
};

/// Applies a transform and "ReverseOrientation" as pbrt-v4 does: without shading normals the geometric normal turns if
/// one, but not both, of reversal and mirroring holds; with shading normals (which turn with the reversal) the
/// geometric normal lies on their side. Throws Error for a singular matrix.
Geometry transformed(const Geometry& geometry, const M44d& matrix, bool reverse_orientation);

/// What bake() left out.
struct BakedMesh {
    Mesh mesh;
    std::vector<std::uint32_t> patches; ///< per triangle, as in Geometry
    int degenerate = 0;                 ///< triangles dropped because their area is zero in float
};

/// Single-precision mesh without degenerate triangles. Shading normals become unit; a zero one is replaced by the
/// area-weighted normal of its triangles. Throws Error if a position is too large for float.
BakedMesh bake(const Geometry& geometry);

/// The surface area in scene units squared.
double area(const Mesh& mesh);

} // namespace tristim
