#pragma once

#include "scene/scene.h"
#include "shared_types.h"

#include <cstdint>
#include <vector>

namespace tristim {

/// An 8-wide BVH flattened for the traversal kernels (layout in kernels/shared_types.h).
struct Bvh {
    std::vector<BvhNode> nodes;  ///< nodes[0] is the root
    std::vector<BvhLeaf> leaves; ///< blocks of eight triangles
    int stack_size = 0;          ///< stack entries that a traversal can need, from the built tree: -D BVH_STACK_SIZE
};

/// A triangle soup: positions of v0, v1, v2 for each triangle. Triangle ids in leaves are indices into it.
struct TriangleSoup {
    std::vector<V3f> v0, v1, v2;
};

/// Builds with Embree's builder (rtcBuildBVH), collapsed to 8 children and 8-triangle blocks by dynamic programming
/// (Ylitie et al. 2017), boxes padded so that watertight traversal never misses. Works for zero triangles. The result
/// does not depend on `threads` (0: as many as there are cores). Throws Error if Embree fails or if a coordinate is not
/// finite or beyond ±1e15.
Bvh build_bvh(const TriangleSoup& triangles, unsigned threads = 0);

} // namespace tristim
