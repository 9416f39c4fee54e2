#pragma once

#include <Imath/ImathVec.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace tristim {

enum class MeshFormat { Obj, Ply };

/// The triangles of a mesh file, in its own coordinates.
struct MeshFile {
    std::vector<Imath::V3f> positions;
    std::vector<Imath::V3f> normals; ///< empty if the file has none, else one per position
    std::vector<Imath::V2f> uv; ///< texture coordinates, v upwards: empty if the file has none, else one per position
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::uint32_t> faces; ///< the file's face that each triangle is part of
    int degenerate_faces = 0;         ///< faces with fewer than three different vertices, left out
};

/// Reads OBJ or PLY (ASCII, binary of either byte order) by OpenMesh. Polygons become triangles; a vertex that has
/// different normals or texture coordinates in different faces (OBJ) becomes several. Corners without texture
/// coordinates in a file that has some get (0, 0).
/// Throws Error naming the file if it is missing, unreadable, malformed or cut short, has no triangles, non-finite
/// vertices, indices out of range or a face of more than 10,000 corners, or is not a manifold: an edge with more than
/// two faces, two neighbours of opposite orientation, or a vertex whose faces form several fans.
MeshFile read_mesh(const std::string& path, MeshFormat format);

} // namespace tristim
