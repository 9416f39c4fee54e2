#include "bvh/binary_tree.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

// Collapse of a binary tree into an eight-wide one with the least expected cost: Ylitie, Karras & Laine 2017,
// "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", section 3.2, equations 1-6. C(n, i) is the
// least cost of representing the subtree at n by at most i siblings. Unlike theirs, a leaf is one block of eight
// triangles that costs the same however full it is.

namespace tristim {
namespace {

constexpr int width = 8;
constexpr float leaf_cost = 1.0f; ///< testing eight triangles, where testing eight boxes costs 1; measured

/// The best ways to represent one binary subtree.
struct Choice {
    std::array<float, width> cost{}; ///< cost[i]: as at most i siblings, i ≥ 1
    std::array<std::uint8_t, width + 1>
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

std::vector<Choice> choose(const Tree& tree) {
    std::vector<Choice> choices(tree.size());
    const float root_area = half_area(tree[0].box);
    const float scale = root_area > 0.0f ? 1.0f / root_area : 1.0f;
    for (std::size_t n = tree.size(); n-- > 0;) {
        const BinaryNode& node = tree[n];
        Choice& choice = choices[n];
        const float area = scale * half_area(node.box);
        const float as_leaf = node.triangle_count <= width ? leaf_cost * area : std::numeric_limits<float>::infinity();
        if (node.is_leaf()) {
            choice.cost.fill(as_leaf);
            choice.one_leaf = true;
            continue;
        }
        const Choice& left = choices[static_cast<std::size_t>(node.left)];
        const Choice& right = choices[static_cast<std::size_t>(node.right)];
        std::array<float, width + 1> distributed;
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

BvhNode empty_node() {
    constexpr float far_away = 1e18f; // products with the inverse direction, at most 1e18, stay finite
    BvhNode node{};
    std::fill(std::begin(node.low_x), std::end(node.low_x), far_away);
    std::fill(std::begin(node.low_y), std::end(node.low_y), far_away);
    std::fill(std::begin(node.low_z), std::end(node.low_z), far_away);
    std::fill(std::begin(node.high_x), std::end(node.high_x), -far_away);
    std::fill(std::begin(node.high_y), std::end(node.high_y), -far_away);
    std::fill(std::begin(node.high_z), std::end(node.high_z), -far_away);
    return node;
}

void set_box(BvhNode& node, std::size_t slot, const Imath::Box3f& box) {
    node.low_x[slot] = box.min.x;
    node.low_y[slot] = box.min.y;
    node.low_z[slot] = box.min.z;
    node.high_x[slot] = box.max.x;
    node.high_y[slot] = box.max.y;
    node.high_z[slot] = box.max.z;
}

BvhLeaf make_leaf(const Tree& tree, int root, const TriangleSoup& triangles) {
    BvhLeaf leaf{};
    std::fill(std::begin(leaf.id), std::end(leaf.id), -1);
    std::size_t lane = 0;
    // In depth-first order the subtree is contiguous.
    for (int n = root, remaining = at(tree, root).triangle_count; remaining > 0; ++n) {
        if (!at(tree, n).is_leaf())
            continue;
        --remaining;
        const auto triangle = static_cast<std::size_t>(at(tree, n).triangle);
        const V3f& v0 = triangles.v0[triangle];
        const V3f& v1 = triangles.v1[triangle];
        const V3f& v2 = triangles.v2[triangle];
        leaf.v0_x[lane] = v0.x, leaf.v0_y[lane] = v0.y, leaf.v0_z[lane] = v0.z;
        leaf.v1_x[lane] = v1.x, leaf.v1_y[lane] = v1.y, leaf.v1_z[lane] = v1.z;
        leaf.v2_x[lane] = v2.x, leaf.v2_y[lane] = v2.y, leaf.v2_z[lane] = v2.z;
        leaf.id[lane++] = static_cast<int>(triangle);
    }
    return leaf;
}

/// Fills the wide node for the subtree at n, depth first, and returns the stack entries that traversing it can need.
int append_node(const Tree& tree, const std::vector<Choice>& choices, int n, std::size_t siblings,
                const TriangleSoup& triangles, Bvh& bvh) {
    std::vector<int> children;
    gather_children(tree, choices, n, siblings, children);
    const std::size_t index = bvh.nodes.size();
    bvh.nodes.push_back(empty_node());
    // The traversal goes on with one child; the others wait on the stack.
    const int waiting = static_cast<int>(children.size()) - 1;
    int needed = waiting;
    for (std::size_t slot = 0; slot < children.size(); ++slot) {
        const int child = children[slot];
        set_box(bvh.nodes[index], slot, at(tree, child).box);
        if (choices[static_cast<std::size_t>(child)].one_leaf) {
            bvh.nodes[index].child[slot] = ~static_cast<int>(bvh.leaves.size());
            bvh.leaves.push_back(make_leaf(tree, child, triangles));
        } else {
            bvh.nodes[index].child[slot] = static_cast<int>(bvh.nodes.size());
            needed = std::max(needed, waiting + append_node(tree, choices, child, width, triangles, bvh));
        }
    }
    return needed;
}

} // namespace

Bvh build_bvh(const TriangleSoup& triangles, unsigned threads) {
    Bvh bvh;
    const Tree tree = build_binary_tree(triangles, threads);
    if (tree.empty()) {
        bvh.nodes.push_back(empty_node());
        return bvh;
    }
    const std::vector<Choice> choices = choose(tree);
    bvh.stack_size = append_node(tree, choices, 0, choices[0].one_leaf ? 1 : width, triangles, bvh);
    return bvh;
}

} // namespace tristim
