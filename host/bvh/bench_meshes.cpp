#include "bvh/bench_meshes.h"

#include <array>
#include <cmath>
#include <numbers>

namespace tristim {
namespace {

void add_triangle(TriangleSoup& soup, const V3f& a, const V3f& b, const V3f& c) {
    soup.v0.push_back(a);
    soup.v1.push_back(b);
    soup.v2.push_back(c);
}

/// A box with the given half-widths, turned about the y axis.
void add_box(TriangleSoup& soup, const V3f& centre, const V3f& half, float degrees) {
    const float angle = degrees * std::numbers::pi_v<float> / 180.0f;
    const auto corner = [&](int index) {
        const V3f local((index & 1) != 0 ? half.x : -half.x, (index & 2) != 0 ? half.y : -half.y,
                        (index & 4) != 0 ? half.z : -half.z);
        return centre + V3f(std::cos(angle) * local.x + std::sin(angle) * local.z, local.y,
                            std::cos(angle) * local.z - std::sin(angle) * local.x);
    };
    constexpr std::array<std::array<int, 4>, 6> faces{
        {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
    for (const auto& face : faces) {
        add_triangle(soup, corner(face[0]), corner(face[1]), corner(face[2]));
        add_triangle(soup, corner(face[0]), corner(face[2]), corner(face[3]));
    }
}

/// A sphere of `rings` × `segments` cells whose radius varies by a tenth.
void add_bumpy_sphere(TriangleSoup& soup, const V3f& centre, float radius, int rings, int segments) {
    const auto point = [&](int ring, int segment) {
        const float theta = std::numbers::pi_v<float> * static_cast<float>(ring) / static_cast<float>(rings);
        const float phi =
            2.0f * std::numbers::pi_v<float> * static_cast<float>(segment % segments) / static_cast<float>(segments);
        const float sine = ring == rings ? 0.0f : std::sin(theta); // exactly one south pole
        const V3f direction(sine * std::cos(phi), std::cos(theta), sine * std::sin(phi));
        const float bump =
            std::sin(23.0f * direction.x) * std::sin(19.0f * direction.y) * std::sin(17.0f * direction.z);
        return centre + radius * (1.0f + 0.1f * bump) * direction;
    };
    for (int ring = 0; ring < rings; ++ring) {
        for (int segment = 0; segment < segments; ++segment) {
            if (ring > 0)
                add_triangle(soup, point(ring, segment), point(ring, segment + 1), point(ring + 1, segment));
            if (ring + 1 < rings)
                add_triangle(soup, point(ring + 1, segment), point(ring, segment + 1), point(ring + 1, segment + 1));
        }
    }
}

} // namespace

BenchMesh boxes_in_room() {
    BenchMesh mesh{"boxes", {}};
    add_box(mesh.triangles, V3f(0.0f), V3f(1.0f), 0.0f);
    add_box(mesh.triangles, V3f(-0.35f, -0.4f, 0.35f), V3f(0.27f, 0.6f, 0.27f), 17.0f);
    add_box(mesh.triangles, V3f(0.4f, -0.7f, -0.2f), V3f(0.27f, 0.3f, 0.27f), -18.0f);
    add_box(mesh.triangles, V3f(0.35f, -0.85f, 0.6f), V3f(0.15f, 0.15f, 0.15f), 40.0f);
    const std::array<V3f, 4> corners{V3f(-0.6f, -0.95f, -0.5f), V3f(-0.1f, -0.95f, -0.5f), V3f(-0.35f, -0.95f, -0.1f),
                                     V3f(-0.35f, -0.5f, -0.35f)};
    add_triangle(mesh.triangles, corners[0], corners[1], corners[2]);
    add_triangle(mesh.triangles, corners[0], corners[3], corners[1]);
    add_triangle(mesh.triangles, corners[1], corners[3], corners[2]);
    add_triangle(mesh.triangles, corners[2], corners[3], corners[0]);
    return mesh;
}

BenchMesh bumpy_spheres_in_room(const std::string& name, int triangles) {
    constexpr int spheres = 8;
    constexpr std::array<V3f, spheres> centres{
        V3f(-0.5f, -0.6f, -0.3f), V3f(0.1f, -0.7f, -0.5f), V3f(0.6f, -0.5f, 0.0f), V3f(-0.1f, -0.6f, 0.3f),
        V3f(-0.6f, 0.1f, 0.5f),   V3f(0.4f, 0.3f, 0.5f),   V3f(-0.2f, 0.5f, 0.0f), V3f(0.5f, -0.65f, 0.6f)};
    // A sphere of n rings and n segments has 2n(n-1) triangles.
    const int n = static_cast<int>(std::lround(std::sqrt(triangles / (2.0 * spheres)) + 0.5));
    BenchMesh mesh{name, {}};
    add_box(mesh.triangles, V3f(0.0f), V3f(1.0f), 0.0f);
    for (const V3f& centre : centres)
        add_bumpy_sphere(mesh.triangles, centre, 0.28f, n, n);
    return mesh;
}

} // namespace tristim
