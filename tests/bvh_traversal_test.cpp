#include "bvh/ray_tracer.h"
#include "bvh_oracle.h"

#include <array>
#include <cstring>
#include <fmt/format.h>
#include <gtest/gtest.h>

namespace tristim {
namespace {

using namespace bvh_test;

Device device() {
    return open_device("");
}

constexpr std::array widths{8, 4, 2};

bool same(const RayHit& a, const RayHit& b) {
    return std::memcmp(&a, &b, sizeof(RayHit)) == 0;
}

/// Traces the rays on the device through a tree and compares each hit that is not as `known` says with the
/// double-precision oracle; any-hit must agree with closest-hit.
std::vector<RayHit> expect_right_hits(const TriangleSoup& soup, const Bvh& bvh, const std::vector<Ray>& rays,
                                      const std::vector<RayHit>& known) {
    RayTracer tracer(device(), bvh);
    const std::vector<RayHit> hits = tracer.trace_closest(rays);
    const std::vector<std::int32_t> occluded = tracer.trace_any(rays);
    std::size_t wrong = 0;
    std::size_t hit_count = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const bool is_known = !known.empty() && same(hits[i], known[i]);
        const std::string problem = is_known ? "" : check_hit(soup, rays[i], hits[i]);
        if (!problem.empty() && ++wrong <= 5)
            ADD_FAILURE() << "ray " << i << ": " << problem;
        EXPECT_EQ(occluded[i] == 1, hits[i].triangle >= 0) << "ray " << i;
        hit_count += hits[i].triangle >= 0 ? 1 : 0;
    }
    EXPECT_EQ(wrong, 0u);
    EXPECT_GT(hit_count, rays.size() / 20) << "too few hits to mean anything";
    return hits;
}

/// The same through trees of every width.
void expect_right_hits(const TriangleSoup& soup, const std::vector<Ray>& rays) {
    std::vector<RayHit> hits;
    for (const int width : widths) {
        SCOPED_TRACE(fmt::format("width {}", width));
        hits = expect_right_hits(soup, build_bvh(soup, width), rays, hits);
    }
}

TriangleSoup random_soup(int count, float size, Random& random) {
    TriangleSoup soup;
    for (int i = 0; i < count; ++i) {
        const V3f centre = random.in_cube(1.0f);
        add(soup, centre + random.in_cube(size), centre + random.in_cube(size), centre + random.in_cube(size));
    }
    return soup;
}

std::vector<Ray> random_rays(int count, float origins, Random& random) {
    std::vector<Ray> rays;
    for (int i = 0; i < count; ++i)
        rays.push_back(make_ray(random.in_cube(origins), random.direction()));
    return rays;
}

TEST(BvhTraversal, RandomTrianglesAgreeWithBruteForce) {
    Random random(1);
    for (const int count : {1, 2, 7, 8, 9, 64, 65, 700}) {
        SCOPED_TRACE(count);
        const TriangleSoup soup = random_soup(count, count < 10 ? 0.9f : 0.3f, random);
        expect_right_hits(soup, random_rays(2000, 1.0f, random));
    }
}

TEST(BvhTraversal, BarycentricsGiveThePointOnTheRay) {
    Random random(2);
    const TriangleSoup soup = random_soup(300, 0.4f, random);
    const std::vector<Ray> rays = random_rays(5000, 1.0f, random);
    const std::vector<RayHit> hits = RayTracer(device(), build_bvh(soup)).trace_closest(rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (hits[i].triangle < 0)
            continue;
        const auto triangle = static_cast<std::size_t>(hits[i].triangle);
        const double u = hits[i].u;
        const double v = hits[i].v;
        const V3d on_triangle =
            (1.0 - u - v) * vertex(soup, triangle, 0) + u * vertex(soup, triangle, 1) + v * vertex(soup, triangle, 2);
        const V3d on_ray =
            V3d(rays[i].origin_x, rays[i].origin_y, rays[i].origin_z) +
            static_cast<double>(hits[i].t) * V3d(rays[i].direction_x, rays[i].direction_y, rays[i].direction_z);
        // The same quotients weigh the vertices in t and here: they differ by the oracle's bound, seen along the
        // triangle.
        EXPECT_LE((on_triangle - on_ray).length(), 3.0 * stand(soup, triangle, rays[i]).t_error + 64.0 * unit_roundoff)
            << "ray " << i;
    }
}

TEST(BvhTraversal, RespectsTMax) {
    Random random(3);
    const TriangleSoup soup = random_soup(300, 0.3f, random);
    std::vector<Ray> rays = random_rays(4000, 1.0f, random);
    for (Ray& ray : rays)
        ray.t_max = random(0.05f, 2.0f);
    expect_right_hits(soup, rays);
}

TEST(BvhTraversal, FarFromTheOriginAndFarFromTheRays) {
    Random random(4);
    TriangleSoup soup = random_soup(300, 0.3f, random);
    const V3f shift(731.0f, -90.0f, 12345.0f);
    for (std::size_t i = 0; i < soup.v0.size(); ++i)
        for (V3f* v : {&soup.v0[i], &soup.v1[i], &soup.v2[i]})
            *v += shift;
    std::vector<Ray> rays;
    for (int i = 0; i < 4000; ++i) {
        const V3f origin = i % 2 == 0 ? shift + random.in_cube(1.0f) : random.in_cube(30000.0f);
        rays.push_back(make_ray(origin, (shift + random.in_cube(1.0f) - origin).normalized()));
    }
    expect_right_hits(soup, rays);
}

TEST(BvhTraversal, DegenerateTrianglesNeitherHideOthersNorBreak) {
    Random random(5);
    TriangleSoup soup = random_soup(200, 0.3f, random);
    for (int i = 0; i < 200; ++i) {
        const V3f a = random.in_cube(1.0f);
        const V3f b = random.in_cube(1.0f);
        switch (i % 4) {
        case 0:
            add(soup, a, a, a);
            break;
        case 1:
            add(soup, a, b, a);
            break;
        case 2:
            add(soup, a, b, 0.5f * (a + b));
            break;
        default:
            add(soup, a, b, 0.5f * (a + b) + random.in_cube(1e-6f));
            break;
        }
    }
    for (int i = 0; i < 40; ++i)
        add(soup, V3f(0.1f), V3f(0.1f), V3f(0.1f));
    std::vector<Ray> rays = random_rays(3000, 1.0f, random);
    for (int i = 0; i < 500; ++i) {
        const V3f origin = random.in_cube(1.0f);
        rays.push_back(make_ray(origin, (V3f(0.1f) - origin).normalized()));
    }
    expect_right_hits(soup, rays);
}

TEST(BvhTraversal, AxisAlignedRaysOnAnAxisAlignedGrid) {
    // Walls of unit squares in the planes at whole coordinates: rays run in, through and beside them.
    TriangleSoup soup;
    for (int axis = 0; axis < 3; ++axis) {
        for (int plane = 0; plane < 3; ++plane) {
            for (int i = 0; i < 4; ++i) {
                for (int j = 0; j < 4; ++j) {
                    const auto corner = [&](int di, int dj) {
                        V3f v;
                        v[axis] = static_cast<float>(2 * plane);
                        v[(axis + 1) % 3] = static_cast<float>(i + di);
                        v[(axis + 2) % 3] = static_cast<float>(j + dj);
                        return v;
                    };
                    add(soup, corner(0, 0), corner(1, 0), corner(1, 1));
                    add(soup, corner(0, 0), corner(1, 1), corner(0, 1));
                }
            }
        }
    }
    Random random(6);
    std::vector<Ray> rays;
    for (int i = 0; i < 3000; ++i) {
        V3f origin;
        for (int axis = 0; axis < 3; ++axis)
            origin[axis] = random.index(2) == 0 ? static_cast<float>(random.index(5)) : random(0.0f, 4.0f);
        V3f direction(random.index(2) == 0 ? 0.0f : -0.0f);
        direction[static_cast<int>(random.index(3))] = random.index(2) == 0 ? 1.0f : -1.0f;
        if (i % 3 == 0)
            direction[static_cast<int>(random.index(3))] = 0.5f;
        rays.push_back(make_ray(origin, direction));
    }
    expect_right_hits(soup, rays);
}

TEST(BvhTraversal, SharedEdgesAndVerticesGiveTheOraclesHits) {
    const TriangleSoup soup = bumpy_sphere(3, V3f(0.0f), 1.0f);
    Random random(7);
    std::vector<Ray> rays;
    for (int i = 0; i < 4000; ++i) {
        const std::size_t triangle = random.index(soup.v0.size());
        const float s = i % 2 == 0 ? random() : 0.0f;
        const V3f target = (1.0f - s) * soup.v0[triangle] + s * soup.v1[triangle];
        const V3f origin = 2.0f * random.direction();
        rays.push_back(make_ray(origin, (target - origin).normalized()));
    }
    expect_right_hits(soup, rays);
}

/// Rays from inside a closed mesh to points on its edges and to its vertices. Returns how many get out.
std::pair<std::size_t, std::size_t> count_leaks(const TriangleSoup& soup, const V3f& centre, float scale, int count,
                                                int width = 8, const BuildOptions& options = {}) {
    RayTracer tracer(device(), build_bvh(soup, width), options);
    Random random(8);
    std::pair<std::size_t, std::size_t> leaks{0, 0};
    for (const bool at_vertices : {false, true}) {
        std::vector<Ray> rays;
        rays.reserve(static_cast<std::size_t>(count));
        for (int i = 0; i < count; ++i) {
            const std::size_t triangle = random.index(soup.v0.size());
            const V3f& a = soup.v0[triangle];
            const V3f& b = random.index(2) == 0 ? soup.v1[triangle] : soup.v2[triangle];
            const float s = at_vertices ? 0.0f : random();
            const V3f origin = centre + random.in_cube(0.4f * scale);
            rays.push_back(make_ray(origin, ((1.0f - s) * a + s * b - origin).normalized()));
        }
        std::size_t& missed = at_vertices ? leaks.second : leaks.first;
        for (const RayHit& hit : tracer.trace_closest(rays))
            missed += hit.triangle < 0 ? 1 : 0;
        for (const std::int32_t occluded : tracer.trace_any(rays))
            missed += occluded == 0 ? 1 : 0;
    }
    return leaks;
}

constexpr std::pair<std::size_t, std::size_t> no_leaks{0, 0};

TEST(BvhTraversal, NoRayLeavesAClosedMesh) {
    const TriangleSoup sphere = bumpy_sphere(5, V3f(0.0f), 1.0f);
    EXPECT_EQ(count_leaks(sphere, V3f(0.0f), 1.0f, 1 << 20), no_leaks);
    for (const int width : {4, 2})
        EXPECT_EQ(count_leaks(sphere, V3f(0.0f), 1.0f, 1 << 17, width), no_leaks) << "width " << width;
}

TEST(BvhTraversal, NoRayLeavesAClosedMeshWithRelaxedMath) {
    BuildOptions options;
    options.fast_math = true;
    EXPECT_EQ(count_leaks(bumpy_sphere(5, V3f(0.0f), 1.0f), V3f(0.0f), 1.0f, 1 << 17, 8, options), no_leaks);
}

TEST(BvhTraversal, NoRayLeavesAClosedMeshFarFromTheOriginOrOfAnyScale) {
    const V3f far_away(370.0f, -12.0f, 8100.0f);
    EXPECT_EQ(count_leaks(bumpy_sphere(4, far_away, 1.0f), far_away, 1.0f, 1 << 17), no_leaks);
    EXPECT_EQ(count_leaks(bumpy_sphere(4, V3f(0.0f), 1e-3f), V3f(0.0f), 1e-3f, 1 << 17), no_leaks);
    EXPECT_EQ(count_leaks(bumpy_sphere(4, V3f(0.0f), 1e5f), V3f(0.0f), 1e5f, 1 << 17), no_leaks);
    EXPECT_EQ(count_leaks(bumpy_sphere(0, V3f(1.0f), 1.0f), V3f(1.0f), 0.5f, 1 << 17), no_leaks);
}

TEST(BvhTraversal, NoRayFromFarAwaySlipsThrough) {
    // A sheet of squares, and rays to points on their sides from so far that the slab test's rounding, 2^-24 of the
    // origin's coordinates, dwarfs the boxes' own padding, 2^-20 of the triangles'.
    constexpr int squares = 32;
    const auto corner = [](int i, int j) {
        return V3f(static_cast<float>(i) / squares, static_cast<float>(j) / squares, 0.0f);
    };
    TriangleSoup soup;
    for (int i = 0; i < squares; ++i) {
        for (int j = 0; j < squares; ++j) {
            add(soup, corner(i, j), corner(i + 1, j), corner(i + 1, j + 1));
            add(soup, corner(i, j), corner(i + 1, j + 1), corner(i, j + 1));
        }
    }
    Random random(10);
    std::vector<Ray> rays;
    for (int i = 0; i < 1 << 17; ++i) {
        V3f target =
            corner(1 + static_cast<int>(random.index(squares - 1)), 1 + static_cast<int>(random.index(squares - 1)));
        target[static_cast<int>(random.index(2))] = random(0.1f, 0.9f);
        const V3f origin(random(2000.0f, 8000.0f), random(2000.0f, 8000.0f), random(2000.0f, 8000.0f));
        rays.push_back(make_ray(origin, (target - origin).normalized()));
    }
    for (const int width : widths) {
        std::size_t missed = 0;
        for (const RayHit& hit : RayTracer(device(), build_bvh(soup, width)).trace_closest(rays))
            missed += hit.triangle < 0 ? 1 : 0;
        EXPECT_EQ(missed, 0u) << "width " << width;
    }
}

TEST(BvhTraversal, NoTrianglesNoHits) {
    Random random(9);
    std::vector<Ray> rays = random_rays(100, 1.0f, random);
    rays.push_back(make_ray(V3f(0.0f), V3f(0.0f, 0.0f, -1.0f)));
    for (const int width : widths) {
        RayTracer tracer(device(), build_bvh({}, width));
        for (const RayHit& hit : tracer.trace_closest(rays))
            EXPECT_EQ(hit.triangle, -1);
        for (const std::int32_t occluded : tracer.trace_any(rays))
            EXPECT_EQ(occluded, 0);
    }
}

} // namespace
} // namespace tristim
