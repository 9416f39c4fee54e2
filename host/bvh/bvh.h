#pragma once

#include "scene/scene.h"
#include "shared_types.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tristim {

/// Nodes or leaves as the device's structs BvhNode and BvhLeaf hold them (kernels/shared_types.h, which numbers the
/// rows): each is so many rows of `width` floats or ints.
class BvhBlocks {
  public:
    BvhBlocks(int rows, int width);

    std::size_t size() const { return words_.size() / block_; }
    std::size_t width() const { return width_; }

    /// Adds a node or leaf of zeros.
    void append() { words_.resize(words_.size() + block_); }

    int integer(std::size_t index, int row, std::size_t lane) const;
    V3f vector(std::size_t index, int row, std::size_t lane) const; ///< of this row and the next two
    void set(std::size_t index, int row, std::size_t lane, int value);
    void set(std::size_t index, int row, std::size_t lane, const V3f& value);

    const std::vector<std::uint32_t>& words() const { return words_; }

  private:
    std::size_t at(std::size_t index, int row, std::size_t lane) const;

    std::size_t width_;
    std::size_t block_; ///< words
    std::vector<std::uint32_t> words_;
};

/// Leaves without triangles.
BvhBlocks empty_leaves(std::size_t count, int width);

/// Puts a triangle into a leaf's lane.
void set_triangle(BvhBlocks& leaves, std::size_t index, std::size_t lane, const std::array<V3f, 3>& vertices, int id);

/// A wide BVH flattened for the traversal kernels.
struct Bvh {
    explicit Bvh(int tree_width = 8);

    int width;          ///< children of a node and triangles of a leaf: -D BVH_WIDTH
    BvhBlocks nodes;    ///< node 0 is the root
    BvhBlocks leaves;   ///< blocks of triangles
    int stack_size = 0; ///< stack entries that a traversal can need, from the built tree: -D BVH_STACK_SIZE
};

/// A triangle soup: positions of v0, v1, v2 for each triangle. Triangle ids in leaves are indices into it.
struct TriangleSoup {
    std::vector<V3f> v0, v1, v2;
};

/// Builds with Embree's builder (rtcBuildBVH), collapsed to `width` (8, 4 or 2) children and triangles in a leaf by
/// dynamic programming (Ylitie et al. 2017), boxes padded so that watertight traversal never misses. Works for zero
/// triangles. The result does not depend on `threads` (0: as many as there are cores). Throws Error if Embree fails or
/// if a coordinate is not finite or beyond ±1e15.
Bvh build_bvh(const TriangleSoup& triangles, int width = 8, unsigned threads = 0);

} // namespace tristim
