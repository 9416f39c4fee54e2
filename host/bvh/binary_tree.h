#pragma once

#include "bvh/bvh.h"

#include <Imath/ImathBox.h>

namespace tristim {

/// A node of the binary tree, its box already padded.
struct BinaryNode {
    Imath::Box3f box;
    int left = -1;     ///< index of the left child, -1 for a leaf
    int right = -1;    ///< index of the right child
    int triangle = -1; ///< the leaf's triangle
    int triangle_count = 1;

    bool is_leaf() const { return left < 0; }
};

/// Builds a binary tree with one triangle in each leaf by Embree's binned surface-area heuristic. Nodes stand in
/// depth-first order, so that children follow their parent; node 0 is the root. Empty for zero triangles.
/// Throws Error if Embree fails.
std::vector<BinaryNode> build_binary_tree(const TriangleSoup& triangles, unsigned threads);

} // namespace tristim
