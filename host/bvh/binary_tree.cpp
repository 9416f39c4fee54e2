#include "bvh/binary_tree.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

#include <embree3/rtcore.h>

namespace tristim {
namespace {

/// Embree's side of a node: the tree as it comes out of the builder's threads, in its own memory.
struct EmbreeNode {
    EmbreeNode* children[2];
    unsigned triangle;
};

struct Releaser {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCBVH bvh) const { rtcReleaseBVH(bvh); }
};
using EmbreeDevice = std::unique_ptr<std::remove_pointer_t<RTCDevice>, Releaser>;
using EmbreeBvh = std::unique_ptr<std::remove_pointer_t<RTCBVH>, Releaser>;

void* create_node(RTCThreadLocalAllocator allocator, unsigned, void*) {
    return new (rtcThreadLocalAlloc(allocator, sizeof(EmbreeNode), alignof(EmbreeNode))) EmbreeNode{};
}

void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, std::size_t, void*) {
    return new (rtcThreadLocalAlloc(allocator, sizeof(EmbreeNode), alignof(EmbreeNode)))
        EmbreeNode{{nullptr, nullptr}, primitives[0].primID};
}

void set_children(void* node, void** children, unsigned, void*) {
    for (int i = 0; i < 2; ++i)
        static_cast<EmbreeNode*>(node)->children[i] = static_cast<EmbreeNode*>(children[i]);
}

void ignore_bounds(void*, const RTCBounds**, unsigned, void*) {}

/// The box that traversal must not miss where it would hit the triangle: see BVH_PADDING in kernels/bvh.h, which widens
/// boxes by the same multiple of the ray's origin.
Imath::Box3f padded_box(const V3f& v0, const V3f& v1, const V3f& v2) {
    constexpr float padding = 0x1p-20f;
    Imath::Box3f box(v0);
    box.extendBy(v1);
    box.extendBy(v2);
    float largest = 0.0f;
    for (int axis = 0; axis < 3; ++axis)
        largest = std::max({largest, std::abs(box.min[axis]), std::abs(box.max[axis])});
    const V3f widening(padding * largest);
    return {box.min - widening, box.max + widening};
}

std::vector<RTCBuildPrimitive> build_primitives(const TriangleSoup& triangles) {
    constexpr float largest_coordinate = 1e15f; // far inside the ±1e18 of empty slots
    std::vector<RTCBuildPrimitive> primitives(triangles.v0.size());
    for (std::size_t i = 0; i < primitives.size(); ++i) {
        for (const V3f& vertex : {triangles.v0[i], triangles.v1[i], triangles.v2[i]})
            for (int axis = 0; axis < 3; ++axis)
                if (!(std::abs(vertex[axis]) <= largest_coordinate))
                    fail("triangle {} has a coordinate {} outside ±1e15", i, vertex[axis]);
        const Imath::Box3f box = padded_box(triangles.v0[i], triangles.v1[i], triangles.v2[i]);
        primitives[i] = {box.min.x, box.min.y, box.min.z, 0, box.max.x, box.max.y, box.max.z, static_cast<unsigned>(i)};
    }
    return primitives;
}

/// Copies the tree into depth-first order, then finds boxes and counts from the leaves up.
std::vector<BinaryNode> flatten(const EmbreeNode* root, const TriangleSoup& triangles) {
    std::vector<BinaryNode> nodes;
    nodes.reserve(2 * triangles.v0.size());
    struct Pending {
        const EmbreeNode* node;
        int parent; ///< whose right child this is, or -1
    };
    std::vector<Pending> pending{{root, -1}};
    while (!pending.empty()) {
        const auto [node, parent] = pending.back();
        pending.pop_back();
        const int index = static_cast<int>(nodes.size());
        BinaryNode& copy = nodes.emplace_back();
        if (parent >= 0)
            nodes[static_cast<std::size_t>(parent)].right = index;
        if (node->children[0] == nullptr) {
            copy.triangle = static_cast<int>(node->triangle);
        } else {
            copy.left = index + 1;
            pending.push_back({node->children[1], index});
            pending.push_back({node->children[0], -1});
        }
    }
    for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) {
        if (node->is_leaf()) {
            const auto triangle = static_cast<std::size_t>(node->triangle);
            node->box = padded_box(triangles.v0[triangle], triangles.v1[triangle], triangles.v2[triangle]);
        } else {
            const BinaryNode& left = nodes[static_cast<std::size_t>(node->left)];
            const BinaryNode& right = nodes[static_cast<std::size_t>(node->right)];
            node->box = left.box;
            node->box.extendBy(right.box);
            node->triangle_count = left.triangle_count + right.triangle_count;
        }
    }
    return nodes;
}

} // namespace

std::vector<BinaryNode> build_binary_tree(const TriangleSoup& triangles, unsigned threads) {
    if (triangles.v0.empty())
        return {};
    std::vector<RTCBuildPrimitive> primitives = build_primitives(triangles);
    const EmbreeDevice device(rtcNewDevice(fmt::format("threads={}", threads).c_str()));
    if (!device)
        fail("Embree cannot start (error {})", static_cast<int>(rtcGetDeviceError(nullptr)));
    const EmbreeBvh bvh(rtcNewBVH(device.get()));

    RTCBuildArguments arguments = rtcDefaultBuildArguments();
    arguments.maxBranchingFactor = 2;
    arguments.maxLeafSize = 1;
    // Boxes that shrink geometrically give a tree as deep as the float exponent has values, in each of three axes.
    arguments.maxDepth = 1024;
    arguments.bvh = bvh.get();
    arguments.primitives = primitives.data();
    arguments.primitiveCount = primitives.size();
    arguments.primitiveArrayCapacity = primitives.size();
    arguments.createNode = create_node;
    arguments.createLeaf = create_leaf;
    arguments.setNodeChildren = set_children;
    arguments.setNodeBounds = ignore_bounds;
    const void* root = rtcBuildBVH(&arguments);
    if (root == nullptr)
        fail("Embree cannot build a BVH of {} triangles (error {})", primitives.size(),
             static_cast<int>(rtcGetDeviceError(device.get())));
    return flatten(static_cast<const EmbreeNode*>(root), triangles);
}

} // namespace tristim
