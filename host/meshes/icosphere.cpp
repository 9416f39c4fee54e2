#include "meshes/icosphere.h"

#include <algorithm>
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

} // namespace tristim
