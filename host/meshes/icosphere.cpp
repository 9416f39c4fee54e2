#include "meshes/icosphere.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace tristim {

namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// The vertex in the middle of an edge, made once for both triangles at the edge.
std::uint32_t midpoint(Icosphere& sphere, std::map<Edge, std::uint32_t>& middles, std::uint32_t a, std::uint32_t b) {
    const auto [it, is_new] =
        middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(sphere.positions.size()));
    if (is_new)
        sphere.positions.push_back((sphere.positions[a] + sphere.positions[b]).normalized());
    return it->second;
}

Icosphere icosahedron() {
    constexpr double g = std::numbers::phi;
    Icosphere result;
    result.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                        {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    for (Imath::V3d& position : result.positions)
        position.normalize();
    result.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                        {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                        {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    return result;
}

/// Turns an icosphere about z until one of the icosahedron's corners lies on the y axis. The great circle in the plane
/// across that axis then runs along edges of all subdivisions, through both poles.
void turn_edges_to_half_plane(Icosphere& sphere) {
    constexpr double g = std::numbers::phi;
    const double scale = 1.0 / std::sqrt(1.0 + g * g);
    // Rounding is some 1e-16 and other vertices are an edge away.
    constexpr double rounding = 1e-12;
    for (Imath::V3d& p : sphere.positions) {
        p = {scale * (g * p.x - p.y), scale * (p.x + g * p.y), p.z};
        for (const int axis : {0, 1}) {
            if (std::abs(p[axis]) < rounding)
                p[axis] = 0.0;
        }
    }
}

} // namespace

Icosphere make_icosphere(int subdivisions) {
    Icosphere sphere = icosahedron();
    for (int i = 0; i < subdivisions; ++i) {
        std::map<Edge, std::uint32_t> middles;
        std::vector<std::array<std::uint32_t, 3>> finer;
        finer.reserve(4 * sphere.triangles.size());
        for (const auto& [a, b, c] : sphere.triangles) {
            const std::uint32_t ab = midpoint(sphere, middles, a, b);
            const std::uint32_t bc = midpoint(sphere, middles, b, c);
            const std::uint32_t ca = midpoint(sphere, middles, c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        sphere.triangles = std::move(finer);
    }
    return sphere;
}

UvSphere make_uv_sphere(int subdivisions) {
    using std::numbers::pi;
    Icosphere sphere = make_icosphere(subdivisions);
    turn_edges_to_half_plane(sphere);
    UvSphere result{sphere.positions, std::vector<Imath::V2f>(sphere.positions.size()), {}};
    std::map<std::pair<std::uint32_t, float>, std::uint32_t> copies; // of a vertex with some u
    std::vector<bool> has_uv(sphere.positions.size(), false);
    const auto with_u = [&](std::uint32_t vertex, double u) {
        const Imath::V3d& p = sphere.positions[vertex];
        const Imath::V2f uv(static_cast<float>(u),
                            static_cast<float>(1.0 - std::atan2(std::hypot(p.x, p.y), p.z) / pi));
        const bool is_first = !has_uv[vertex];
        const auto [it, is_new] =
            copies.try_emplace({vertex, uv.x}, is_first ? vertex : static_cast<std::uint32_t>(result.positions.size()));
        if (is_first) {
            result.uv[vertex] = uv;
            has_uv[vertex] = true;
        } else if (is_new) {
            result.positions.push_back(p);
            result.uv.push_back(uv);
        }
        return it->second;
    };
    for (const auto& triangle : sphere.triangles) {
        double middle_y = 0.0;
        for (const std::uint32_t vertex : triangle)
            middle_y += sphere.positions[vertex].y;
        std::array<double, 3> u{};
        double sum = 0.0;
        for (std::size_t i = 0; i < 3; ++i) {
            const Imath::V3d& p = sphere.positions[triangle[i]];
            const double turn = std::atan2(p.y, p.x) / (2.0 * pi);
            u[i] = turn < 0.0 || (turn == 0.0 && middle_y < 0.0) ? turn + 1.0 : turn;
            sum += p.x == 0.0 && p.y == 0.0 ? 0.0 : u[i];
        }
        std::array<std::uint32_t, 3> corners{};
        for (std::size_t i = 0; i < 3; ++i) {
            const Imath::V3d& p = sphere.positions[triangle[i]];
            corners[i] = with_u(triangle[i], p.x == 0.0 && p.y == 0.0 ? 0.5 * sum : u[i]);
        }
        result.triangles.push_back(corners);
    }
    return result;
}

} // namespace tristim
