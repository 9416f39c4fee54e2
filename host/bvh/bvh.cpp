#include "bvh/bvh.h"

#include <bit>

namespace tristim {

BvhBlocks::BvhBlocks(int rows, int width)
    : width_(static_cast<std::size_t>(width)), block_(static_cast<std::size_t>(rows) * width_) {}

std::size_t BvhBlocks::at(std::size_t index, int row, std::size_t lane) const {
    return index * block_ + static_cast<std::size_t>(row) * width_ + lane;
}

int BvhBlocks::integer(std::size_t index, int row, std::size_t lane) const {
    return std::bit_cast<int>(words_[at(index, row, lane)]);
}

V3f BvhBlocks::vector(std::size_t index, int row, std::size_t lane) const {
    const auto number = [&](int axis) { return std::bit_cast<float>(words_[at(index, row + axis, lane)]); };
    return {number(0), number(1), number(2)};
}

void BvhBlocks::set(std::size_t index, int row, std::size_t lane, int value) {
    words_[at(index, row, lane)] = std::bit_cast<std::uint32_t>(value);
}

void BvhBlocks::set(std::size_t index, int row, std::size_t lane, const V3f& value) {
    for (int axis = 0; axis < 3; ++axis)
        words_[at(index, row + axis, lane)] = std::bit_cast<std::uint32_t>(value[axis]);
}

BvhBlocks empty_leaves(std::size_t count, int width) {
    BvhBlocks leaves(BVH_LEAF_ROWS, width);
    for (std::size_t i = 0; i < count; ++i) {
        leaves.append();
        for (std::size_t lane = 0; lane < leaves.width(); ++lane)
            leaves.set(i, BVH_ID, lane, -1);
    }
    return leaves;
}

void set_triangle(BvhBlocks& leaves, std::size_t index, std::size_t lane, const std::array<V3f, 3>& vertices, int id) {
    leaves.set(index, BVH_V0, lane, vertices[0]);
    leaves.set(index, BVH_V1, lane, vertices[1]);
    leaves.set(index, BVH_V2, lane, vertices[2]);
    leaves.set(index, BVH_ID, lane, id);
}

Bvh::Bvh(int tree_width) : width(tree_width), nodes(BVH_NODE_ROWS, tree_width), leaves(BVH_LEAF_ROWS, tree_width) {}

} // namespace tristim
