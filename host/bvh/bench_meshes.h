#pragma once

#include "bvh/bvh.h"

#include <string>

namespace tristim {

/// A mesh to measure ray traversal on: things in the closed room [-1, 1]³.
struct BenchMesh {
    std::string name;
    TriangleSoup triangles;
};

/// Three boxes and a tetrahedron in the room: 52 triangles.
BenchMesh boxes_in_room();

/// Eight bumpy spheres in the room, about `triangles` triangles in all.
BenchMesh bumpy_spheres_in_room(const std::string& name, int triangles);

} // namespace tristim
