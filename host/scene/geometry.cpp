#include "scene/geometry.h"

#include "base/error.h"
#include "scene/transforms.h"

#include <algorithm>
#include <cmath>

namespace tristim {

namespace {

template <typename Vector>
V3d area_normal(const std::vector<Vector>& positions, const std::array<std::uint32_t, 3>& triangle) {
    const V3d v0(positions[triangle[0]]), v1(positions[triangle[1]]), v2(positions[triangle[2]]);
    return (v1 - v0).cross(v2 - v0);
}

bool is_degenerate(const std::vector<V3f>& positions, const std::array<std::uint32_t, 3>& triangle) {
    const V3d v0(positions[triangle[0]]), v1(positions[triangle[1]]), v2(positions[triangle[2]]);
    const double longest2 = std::max({(v1 - v0).length2(), (v2 - v0).length2(), (v2 - v1).length2()});
    // The cross product of float positions in double is exact to some 1e-16 of the longest edge squared, so that
    // anything below 1e-14 is a line or a point.
    return area_normal(positions, triangle).length() <= 1e-14 * longest2;
}

std::vector<V3f> unit_normals(const Geometry& geometry) {
    std::vector<V3d> summed(geometry.positions.size(), V3d(0.0));
    for (const auto& triangle : geometry.triangles) {
        const V3d normal = area_normal(geometry.positions, triangle);
        for (const std::uint32_t vertex : triangle)
            summed[vertex] += normal;
    }
    std::vector<V3f> result;
    result.reserve(geometry.normals.size());
    for (std::size_t i = 0; i < geometry.normals.size(); ++i) {
        V3d normal = geometry.normals[i].normalized();
        if (normal.length2() == 0.0)
            normal = summed[i].normalized();
        if (normal.length2() == 0.0)
            normal = V3d(0.0, 0.0, 1.0);
        result.emplace_back(normal);
    }
    return result;
}

} // namespace

Geometry transformed(const Geometry& geometry, const M44d& matrix, bool reverse_orientation) {
    Geometry result = geometry;
    for (V3d& position : result.positions)
        position = transform_point(matrix, position);
    const M44d for_normals = normal_matrix(matrix);
    for (V3d& normal : result.normals)
        normal = transform_vector(for_normals, normal) * (reverse_orientation ? -1.0 : 1.0);

    const bool flip = reverse_orientation != swaps_handedness(matrix);
    for (auto& triangle : result.triangles) {
        bool turn = flip;
        if (!result.normals.empty()) {
            V3d shading(0.0);
            for (const std::uint32_t vertex : triangle)
                shading += result.normals[vertex].normalized();
            const double side = shading.dot(area_normal(result.positions, triangle));
            turn = side == 0.0 ? flip : side < 0.0;
        }
        if (turn)
            std::swap(triangle[1], triangle[2]);
    }
    return result;
}

BakedMesh bake(const Geometry& geometry) {
    BakedMesh result;
    result.mesh.positions.reserve(geometry.positions.size());
    for (const V3d& position : geometry.positions) {
        const V3f single(position);
        if (!std::isfinite(single.x) || !std::isfinite(single.y) || !std::isfinite(single.z))
            fail("the position ({}, {}, {}) is too large", position.x, position.y, position.z);
        result.mesh.positions.push_back(single);
    }
    if (!geometry.normals.empty())
        result.mesh.normals = unit_normals(geometry);
    result.mesh.uv = geometry.uv;
    for (std::size_t i = 0; i < geometry.triangles.size(); ++i) {
        if (is_degenerate(result.mesh.positions, geometry.triangles[i])) {
            ++result.degenerate;
        } else {
            result.mesh.triangles.push_back(geometry.triangles[i]);
            result.patches.push_back(geometry.patches[i]);
        }
    }
    return result;
}

double area(const Mesh& mesh) {
    double sum = 0.0;
    for (const auto& triangle : mesh.triangles)
        sum += 0.5 * area_normal(mesh.positions, triangle).length();
    return sum;
}

} // namespace tristim
