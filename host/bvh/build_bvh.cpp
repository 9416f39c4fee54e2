#include "base/error.h"
#include "bvh/binary_tree.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

// Collapse of a binary tree into a wide one with the least expected cost: Ylitie, Karras & Laine 2017,
// "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", section 3.2, equations 1-6. C(n, i) is the
// least cost of representing the subtree at n by at most i siblings. Unlike theirs, a leaf is one block of as many
// triangles as a node has children, which costs the same however full it is.

namespace tristim {
namespace {

constexpr int largest_width = 8;
constexpr float leaf_cost = 1.0f; ///< testing a leaf's triangles, where testing a node's boxes costs 1; measured

/// The best ways to represent one binary subtree.
struct Choice {
    std::array<float, largest_width> cost{}; ///< cost[i]: as at most i siblings, i ≥ 1
    std::array<std::uint8_t, largest_width + 1>
        left{};            ///< left[i]: how many of i siblings the left child gets; 0: i-1 are as good
    bool one_leaf = false; ///< as one sibling: a leaf rather than a node
};

using Tree = std::vector<BinaryNode>;

const BinaryNode& at(const Tree& tree, int index) {
    return tree[static_cast<std::size_t>(index)];
}

float half_area(const Imath::Box3f& box) {
    const V3f size = box.size();
    return size.x * size.y + size.y * size.z + size.z * size.x;
}

std::vector<Choice> choose(const Tree& tree, int tree_width) {
    const auto width = static_cast<std::size_t>(tree_width);
    std::vector<Choice> choices(tree.size());
    const float root_area = half_area(tree[0].box);
    const float scale = root_area > 0.0f ? 1.0f / root_area : 1.0f;
    for (std::size_t n = tree.size(); n-- > 0;) {
        const BinaryNode& node = tree[n];
        Choice& choice = choices[n];
        const float area = scale * half_area(node.box);
        const float as_leaf =
            node.triangle_count <= tree_width ? leaf_cost * area : std::numeric_limits<float>::infinity();
        if (node.is_leaf()) {
            choice.cost.fill(as_leaf);
            choice.one_leaf = true;
            continue;
        }
        const Choice& left = choices[static_cast<std::size_t>(node.left)];
        const Choice& right = choices[static_cast<std::size_t>(node.right)];
        std::array<float, largest_width + 1> distributed;
        for (std::size_t i = 2; i <= width; ++i) {
            distributed[i] = std::numeric_limits<float>::infinity();
            for (std::size_t k = 1; k < i; ++k) {
                const float cost = left.cost[k] + right.cost[i - k];
                if (cost < distributed[i]) {
                    distributed[i] = cost;
                    choice.left[i] = static_cast<std::uint8_t>(k);
                }
            }
        }
        const float as_node = distributed[width] + area;
        choice.one_leaf = as_leaf <= as_node;
        choice.cost[1] = std::min(as_leaf, as_node);
        for (std::size_t i = 2; i < width; ++i) {
            choice.cost[i] = std::min(distributed[i], choice.cost[i - 1]);
            if (choice.cost[i - 1] <= distributed[i])
                choice.left[i] = 0;
        }
    }
    return choices;
}

/// Appends the binary nodes that `siblings` slots of a wide node take to represent the subtree at n.
void gather_children(const Tree& tree, const std::vector<Choice>& choices, int n, std::size_t siblings,
                     std::vector<int>& children) {
    const Choice& choice = choices[static_cast<std::size_t>(n)];
    while (siblings > 1 && choice.left[siblings] == 0)
        --siblings;
    if (siblings == 1) {
        children.push_back(n);
        return;
    }
    const std::size_t to_left = choice.left[siblings];
    gather_children(tree, choices, at(tree, n).left, to_left, children);
    gather_children(tree, choices, at(tree, n).right, siblings - to_left, children);
}

void append_empty_node(Bvh& bvh) {
    const V3f far_away(1e18f); // products with the inverse direction, at most 1e18, stay finite
    const std::size_t index = bvh.nodes.size();
    bvh.nodes.append();
    for (std::size_t slot = 0; slot < bvh.nodes.width(); ++slot) {
        bvh.nodes.set(index, BVH_LOW, slot, far_away);
        bvh.nodes.set(index, BVH_HIGH, slot, -far_away);
    }
}

void append_leaf(const Tree& tree, int root, const TriangleSoup& triangles, Bvh& bvh) {
    const std::size_t index = bvh.leaves.size();
    bvh.leaves.append();
    std::size_t lane = 0;
    // In depth-first order the subtree is contiguous.
    for (int n = root, remaining = at(tree, root).triangle_count; remaining > 0; ++n) {
        if (!at(tree, n).is_leaf())
            continue;
        --remaining;
        const int triangle = at(tree, n).triangle;
        const auto i = static_cast<std::size_t>(triangle);
        set_triangle(bvh.leaves, index, lane++, {triangles.v0[i], triangles.v1[i], triangles.v2[i]}, triangle);
    }
    for (; lane < bvh.leaves.width(); ++lane)
        bvh.leaves.set(index, BVH_ID, lane, -1);
}

/// Fills the wide node for the subtree at n, depth first, and returns the stack entries that traversing it can need.
int append_node(const Tree& tree, const std::vector<Choice>& choices, int n, std::size_t siblings,
                const TriangleSoup& triangles, Bvh& bvh) {
    std::vector<int> children;
    gather_children(tree, choices, n, siblings, children);
    const std::size_t index = bvh.nodes.size();
    append_empty_node(bvh);
    // The traversal goes on with one child; the others wait on the stack.
    const int waiting = static_cast<int>(children.size()) - 1;
    int needed = waiting;
    for (std::size_t slot = 0; slot < children.size(); ++slot) {
        const int child = children[slot];
        bvh.nodes.set(index, BVH_LOW, slot, at(tree, child).box.min);
        bvh.nodes.set(index, BVH_HIGH, slot, at(tree, child).box.max);
        if (choices[static_cast<std::size_t>(child)].one_leaf) {
            bvh.nodes.set(index, BVH_CHILD, slot, ~static_cast<int>(bvh.leaves.size()));
            append_leaf(tree, child, triangles, bvh);
        } else {
            bvh.nodes.set(index, BVH_CHILD, slot, static_cast<int>(bvh.nodes.size()));
            needed = std::max(needed, waiting + append_node(tree, choices, child, bvh.nodes.width(), triangles, bvh));
        }
    }
    return needed;
}

} // namespace

Bvh build_bvh(const TriangleSoup& triangles, int width, unsigned threads) {
    if (width != 8 && width != 4 && width != 2)
        fail("a BVH may be 8, 4 or 2 wide, not {}", width);
    Bvh bvh(width);
    const Tree tree = build_binary_tree(triangles, threads);
    if (tree.empty()) {
        append_empty_node(bvh);
        return bvh;
    }
    const std::vector<Choice> choices = choose(tree, width);
    const std::size_t siblings = choices[0].one_leaf ? 1 : bvh.nodes.width();
    bvh.stack_size = append_node(tree, choices, 0, siblings, triangles, bvh);
    return bvh;
}

} // namespace tristim
