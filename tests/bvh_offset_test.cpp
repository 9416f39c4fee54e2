#include "bvh/ray_tracer.h"
#include "bvh_oracle.h"

#include <algorithm>
#include <fmt/format.h>
#include <gtest/gtest.h>

namespace tristim {
namespace {

using namespace bvh_test;

/// For each ray: where it hits, moved off the triangle to the side given by the sign of Ray::unused.
constexpr const char* probe = R"~~~(
kernel void probe_offset(const global BvhNode* nodes, const global BvhLeaf* leaves, const global Ray* rays,
                         const global float* vertices, global float* points) {
    const size_t i = get_global_id(0);
    const Ray ray = rays[i];
    const Hit hit = bvh_closest_hit(nodes, leaves, (float3)(ray.origin_x, ray.origin_y, ray.origin_z),
                                    (float3)(ray.direction_x, ray.direction_y, ray.direction_z), ray.t_max);
    const int triangle = max(hit.triangle, 0);
    const float3 v0 = vload3(3 * triangle, vertices);
    const float3 v1 = vload3(3 * triangle + 1, vertices);
    const float3 v2 = vload3(3 * triangle + 2, vertices);
    const float3 normal = copysign(1.0f, ray.unused) * normalize(cross(v1 - v0, v2 - v0));
    const float3 largest = max(fabs(v0), max(fabs(v1), fabs(v2)));
    const float3 p = v0 + hit.u * (v1 - v0) + hit.v * (v2 - v0);
    vstore3(offset_from_triangle(p, normal, max(largest.x, max(largest.y, largest.z))), i, points);
}
)~~~";

std::vector<V3f> offset_hits(const Device& device, const TriangleSoup& soup, const std::vector<Ray>& rays) {
    const Bvh bvh = build_bvh(soup);
    std::vector<float> corners;
    for (std::size_t i = 0; i < soup.v0.size(); ++i)
        for (const V3f& v : {soup.v0[i], soup.v1[i], soup.v2[i]})
            corners.insert(corners.end(), {v.x, v.y, v.z});
    ::cl::Program program(device.context, flatten_kernel_source("bvh.h") + probe);
    program.build(device.device, "-cl-std=CL1.2");
    ::cl::Kernel kernel(program, "probe_offset");
    const Buffer<std::uint32_t> nodes(device, "nodes", bvh.nodes.words());
    const Buffer<std::uint32_t> leaves(device, "leaves", bvh.leaves.words());
    const Buffer<Ray> ray_buffer(device, "rays", rays);
    const Buffer<float> vertices(device, "vertices", corners);
    const Buffer<float> points(device, "points", 3 * rays.size());
    kernel.setArg(0, nodes.cl());
    kernel.setArg(1, leaves.cl());
    kernel.setArg(2, ray_buffer.cl());
    kernel.setArg(3, vertices.cl());
    kernel.setArg(4, points.cl());
    device.queue.enqueueNDRangeKernel(kernel, ::cl::NullRange, ::cl::NDRange(rays.size()));
    std::vector<V3f> result;
    const std::vector<float> flat = points.read(device);
    for (std::size_t i = 0; i < rays.size(); ++i)
        result.emplace_back(flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]);
    return result;
}

/// A square of two triangles with sides of 2·half, tilted anyhow, through the origin.
struct Square {
    V3f normal; ///< that of the triangles
    TriangleSoup soup;

    Square(float half, Random& random) : normal(random.direction()) {
        const V3f tangent = (normal % random.direction()).normalized();
        const V3f bitangent = normal % tangent;
        const auto corner = [&](float a, float b) { return half * (a * tangent + b * bitangent); };
        add(soup, corner(-1, -1), corner(1, -1), corner(1, 1));
        add(soup, corner(-1, -1), corner(1, 1), corner(-1, 1));
    }
};

/// Rays leave the square from where others hit it within `reach` of the origin: those that go away from it must miss
/// it, grazing ones too, and those that go through it must hit it.
void expect_no_self_intersection(const Device& device, float half, float reach) {
    SCOPED_TRACE(fmt::format("square of half-width {}, hits within {}", half, reach));
    Random random(11);
    const Square square(half, random);
    std::vector<Ray> arriving;
    for (int i = 0; i < 20000; ++i) {
        const V3f anywhere = random.in_cube(reach);
        const V3f target = anywhere - (anywhere ^ square.normal) * square.normal;
        const V3f origin = target + reach * (square.normal + random.in_cube(0.5f));
        arriving.push_back(make_ray(origin, (target - origin).normalized()));
        arriving.back().unused = i % 2 == 0 ? 1.0f : -1.0f;
    }
    const std::vector<V3f> points = offset_hits(device, square.soup, arriving);
    std::vector<Ray> away, through;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const V3f side = arriving[i].unused * square.normal;
        V3f direction = random.direction();
        const float cosine = direction ^ side;
        if (i % 3 == 0)
            direction -= 0.999f * cosine * side;
        away.push_back(make_ray(points[i], (cosine < 0.0f ? -direction : direction).normalized()));
        through.push_back(make_ray(points[i], (-side + random.in_cube(0.5f)).normalized()));
        // No further than the padding, 256 units in the last place of each coordinate and 2^-16 explain.
        const float furthest = 0x1p-20f * 1.5f * half + 0x1p-15f * std::max(reach, 1.0f) + 0x1p-16f;
        EXPECT_LE(std::abs(points[i] ^ square.normal), 2.0f * furthest);
    }
    RayTracer tracer(device, build_bvh(square.soup));
    std::size_t hit_again = 0;
    for (const RayHit& hit : tracer.trace_closest(away))
        hit_again += hit.triangle >= 0 ? 1 : 0;
    EXPECT_EQ(hit_again, 0u);
    std::size_t fallen_through = 0;
    for (const RayHit& hit : tracer.trace_closest(through))
        fallen_through += hit.triangle < 0 ? 1 : 0;
    EXPECT_EQ(fallen_through, 0u);
}

TEST(BvhOffset, LeavesTrianglesOfAnySizeWithoutMeetingThemAgain) {
    const Device device = open_device("");
    for (const float half : {0.1f, 1.0f, 100.0f, 1e4f})
        for (const float reach : {0.01f, 1.0f, 100.0f})
            if (reach < 0.5f * half)
                expect_no_self_intersection(device, half, reach);
}

} // namespace
} // namespace tristim
