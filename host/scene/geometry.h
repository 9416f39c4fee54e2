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
    int degenerate = 0;                 ///< triangles dropped because they have no area
};

/// Whether three points lie on a line, as far as double precision tells.
bool is_degenerate(const V3d& v0, const V3d& v1, const V3d& v2);

/// The mesh without degenerate triangles. Shading normals become unit; a zero one is replaced by the
/// area-weighted normal of its triangles. Throws Error if a position is too large for float.
BakedMesh bake(const Geometry& geometry);

/// The point that single-precision coordinates should count from: the middle of the shapes' bounding box if the world's
/// origin is further from it than the box's diagonal, so that no coordinate loses precision; else the world's origin.
V3d coordinate_origin(const std::vector<Shape>& shapes);

/// How coarse a mesh's coordinates are over its size (its box's diagonal): the spacing of floats at the largest one,
/// counted from `origin`, or that of doubles in the world's coordinates if that is more.
double relative_spacing(const std::vector<V3d>& positions, const V3d& origin);

/// The relative spacing from which on images suffer: some 2000 sizes away from the origin of single-precision
/// coordinates. There images of one seed differ from those of exact coordinates by a third of the noise of 8 passes.
inline constexpr double coarse_spacing = 0x1p-12;

/// The surface area in scene units squared.
double area(const Mesh& mesh);

/// A parallelogram that faces where edge1 × edge2 points, of two triangles; `area_light` -1 for one that does not emit.
Shape parallelogram(const V3d& corner, const V3d& edge1, const V3d& edge2, int material, int area_light = -1);

} // namespace tristim
