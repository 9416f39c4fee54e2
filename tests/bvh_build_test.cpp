#include "base/error.h"
#include "bvh/bench_meshes.h"
#include "bvh/bvh.h"
#include "bvh/ray_tracer.h"
#include "bvh_oracle.h"

#include <Imath/ImathBox.h>
#include <array>
#include <fmt/format.h>
#include <functional>
#include <gtest/gtest.h>
#include <limits>

namespace tristim {
namespace {

using namespace bvh_test;

constexpr std::array widths{8, 4, 2};

Imath::Box3f slot_box(const Bvh& bvh, std::size_t node, std::size_t slot) {
    return {bvh.nodes.vector(node, BVH_LOW, slot), bvh.nodes.vector(node, BVH_HIGH, slot)};
}

bool contains(const Imath::Box3f& outer, const Imath::Box3f& inner) {
    return outer.intersects(inner.min) && outer.intersects(inner.max);
}

/// Walks the whole tree: every box holds what is below it, every node, block and triangle is reached once.
void expect_sound(const Bvh& bvh, const TriangleSoup& soup) {
    std::vector<int> seen_nodes(bvh.nodes.size(), 0);
    std::vector<int> seen_leaves(bvh.leaves.size(), 0);
    std::vector<int> seen_triangles(soup.v0.size(), 0);
    const std::function<void(int, const Imath::Box3f&)> walk = [&](int reference, const Imath::Box3f& box) {
        if (reference < 0) {
            const auto index = static_cast<std::size_t>(~reference);
            ASSERT_LT(index, bvh.leaves.size());
            ++seen_leaves[index];
            for (std::size_t lane = 0; lane < bvh.leaves.width(); ++lane) {
                const V3f v0 = bvh.leaves.vector(index, BVH_V0, lane);
                const V3f v1 = bvh.leaves.vector(index, BVH_V1, lane);
                const V3f v2 = bvh.leaves.vector(index, BVH_V2, lane);
                const int id = bvh.leaves.integer(index, BVH_ID, lane);
                if (id < 0) {
                    EXPECT_TRUE(v0 == v1 && v1 == v2);
                    continue;
                }
                const auto triangle = static_cast<std::size_t>(id);
                ASSERT_LT(triangle, soup.v0.size());
                ++seen_triangles[triangle];
                EXPECT_TRUE(v0 == soup.v0[triangle] && v1 == soup.v1[triangle] && v2 == soup.v2[triangle]);
                for (const V3f& v : {v0, v1, v2})
                    EXPECT_TRUE(box.intersects(v));
            }
            return;
        }
        const auto index = static_cast<std::size_t>(reference);
        ASSERT_LT(index, bvh.nodes.size());
        ++seen_nodes[index];
        for (std::size_t slot = 0; slot < bvh.nodes.width(); ++slot) {
            const Imath::Box3f child = slot_box(bvh, index, slot);
            if (child.isEmpty())
                continue;
            EXPECT_TRUE(contains(box, child));
            walk(bvh.nodes.integer(index, BVH_CHILD, slot), child);
        }
    };
    Imath::Box3f everything;
    everything.makeInfinite();
    walk(0, everything);
    for (const auto* seen : {&seen_nodes, &seen_leaves, &seen_triangles})
        for (const int count : *seen)
            ASSERT_EQ(count, 1);
}

/// The most entries on the stack of a traversal that hits every box, children visited in the worst order.
int worst_stack(const Bvh& bvh) {
    const std::function<int(int)> worst = [&](int reference) {
        if (reference < 0)
            return 0;
        const auto node = static_cast<std::size_t>(reference);
        int pushed = 0;
        int below = 0;
        for (std::size_t slot = 0; slot < bvh.nodes.width(); ++slot) {
            if (slot_box(bvh, node, slot).isEmpty())
                continue;
            ++pushed;
            below = std::max(below, worst(bvh.nodes.integer(node, BVH_CHILD, slot)));
        }
        return pushed == 0 ? 0 : pushed - 1 + below; // the traversal goes on with one, the others wait
    };
    return worst(0);
}

bool same_bytes(const Bvh& a, const Bvh& b) {
    return a.stack_size == b.stack_size && a.nodes.words() == b.nodes.words() && a.leaves.words() == b.leaves.words();
}

/// Triangles around one point that halve in size: a tree as deep as it gets.
TriangleSoup nested_triangles() {
    TriangleSoup soup;
    for (int i = -120; i < 40; ++i) {
        const float size = std::ldexp(1.0f, i);
        add(soup, V3f(size, 0, 0), V3f(0, size, 0), V3f(0, 0, size));
        add(soup, V3f(-size, 0, 0), V3f(0, -size, 0), V3f(0, 0, -size));
    }
    return soup;
}

TriangleSoup coincident_triangles() {
    TriangleSoup soup;
    for (int i = 0; i < 5000; ++i)
        add(soup, V3f(0, 0, 0), V3f(1, 0, 0), V3f(0, 1, 0));
    return soup;
}

void expect_sound_trees(const TriangleSoup& soup) {
    for (const int width : widths) {
        SCOPED_TRACE(fmt::format("width {}", width));
        const Bvh bvh = build_bvh(soup, width);
        expect_sound(bvh, soup);
        EXPECT_EQ(bvh.stack_size, worst_stack(bvh));
    }
}

TEST(BvhBuild, EveryTriangleIsReachedOnceWithinItsBoxes) {
    for (const int count : {1, 8, 9, 1000}) {
        SCOPED_TRACE(count);
        Random random(static_cast<std::uint32_t>(count));
        TriangleSoup soup;
        for (int i = 0; i < count; ++i)
            add(soup, random.in_cube(1.0f), random.in_cube(1.0f), random.in_cube(1.0f));
        expect_sound_trees(soup);
    }
    expect_sound_trees(bumpy_spheres_in_room("spheres", 20000).triangles);
}

TEST(BvhBuild, AsManyTrianglesAsTheTreeIsWideAreOneBlock) {
    TriangleSoup soup = bumpy_sphere(0, V3f(0.0f), 1.0f);
    ASSERT_EQ(soup.v0.size(), 8u);
    for (const int width : widths) {
        for (auto* vertices : {&soup.v0, &soup.v1, &soup.v2})
            vertices->resize(static_cast<std::size_t>(width));
        const Bvh bvh = build_bvh(soup, width);
        EXPECT_EQ(bvh.nodes.size(), 1u);
        EXPECT_EQ(bvh.leaves.size(), 1u);
    }
}

TEST(BvhBuild, BlocksAreWellFilled) {
    const BenchMesh mesh = bumpy_spheres_in_room("spheres", 100'000);
    for (const int width : {8, 4}) {
        const Bvh bvh = build_bvh(mesh.triangles, width);
        // A plain eight-way build fills 45 % of the lanes; the collapse is there to do better.
        EXPECT_GT(static_cast<double>(mesh.triangles.v0.size()) / (width * static_cast<double>(bvh.leaves.size())),
                  0.6);
    }
}

TEST(BvhBuild, DoesNotDependOnThreads) {
    const std::vector<TriangleSoup> soups{bumpy_spheres_in_room("spheres", 100'000).triangles, nested_triangles(),
                                          coincident_triangles()};
    for (const TriangleSoup& soup : soups) {
        const Bvh one = build_bvh(soup, 8, 1);
        EXPECT_TRUE(same_bytes(one, build_bvh(soup, 8, 2)));
        EXPECT_TRUE(same_bytes(one, build_bvh(soup, 8, 0)));
    }
}

TEST(BvhBuild, PathologicalTreesAreSoundAndTraversable) {
    for (const TriangleSoup& soup : {nested_triangles(), coincident_triangles()}) {
        expect_sound_trees(soup);
        Random random(1);
        std::vector<Ray> rays;
        for (int i = 0; i < 200; ++i) {
            const V3f origin = random.in_cube(4.0f);
            rays.push_back(make_ray(origin, (0.01f * random.in_cube(1.0f) - origin).normalized()));
        }
        for (const int width : {8, 4}) {
            const std::vector<RayHit> hits = RayTracer(open_device(""), build_bvh(soup, width)).trace_closest(rays);
            for (std::size_t i = 0; i < rays.size(); ++i)
                EXPECT_EQ(check_hit(soup, rays[i], hits[i]), "") << "ray " << i << ", width " << width;
        }
    }
}

TEST(BvhBuild, NoTrianglesMakeAnEmptyRoot) {
    const Bvh bvh = build_bvh({});
    ASSERT_EQ(bvh.nodes.size(), 1u);
    EXPECT_EQ(bvh.leaves.size(), 0u);
    EXPECT_EQ(bvh.stack_size, 0);
    for (std::size_t slot = 0; slot < bvh.nodes.width(); ++slot)
        EXPECT_TRUE(slot_box(bvh, 0, slot).isEmpty());
}

TEST(BvhBuild, RejectsCoordinatesThatItCannotHandle) {
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -2e15f}) {
        TriangleSoup soup;
        add(soup, V3f(0.0f), V3f(1.0f), V3f(0.0f, bad, 0.0f));
        EXPECT_THROW(build_bvh(soup), Error);
    }
}

TEST(BvhBuild, RejectsWidthsThatKernelsCannotTake) {
    for (const int width : {16, 7, 3, 1, 0, -8})
        EXPECT_THROW(build_bvh({}, width), Error) << width;
}

} // namespace
} // namespace tristim
