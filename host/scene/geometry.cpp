#include "scene/geometry.h"

#include "base/error.h"
#include "scene/transforms.h"

#include <Imath/ImathBox.h>

#include <algorithm>
#include <cmath>

namespace tristim {

namespace {

V3d area_normal(const std::vector<V3d>& positions, const std::array<std::uint32_t, 3>& triangle) {
    const V3d &v0 = positions[triangle[0]], &v1 = positions[triangle[1]], &v2 = positions[triangle[2]];
    return (v1 - v0).cross(v2 - v0);
}

Imath::Box3d bounds(const std::vector<V3d>& positions) {
    Imath::Box3d box;
    for (const V3d& position : positions)
        box.extendBy(position);
    return box;
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

bool is_degenerate(const V3d& v0, const V3d& v1, const V3d& v2) {
    const double longest2 = std::max({(v1 - v0).length2(), (v2 - v0).length2(), (v2 - v1).length2()});
    // The cross product is exact to some 1e-16 of the longest edge squared, so that anything below 1e-14 is a line or a
    // point.
    return (v1 - v0).cross(v2 - v0).length() <= 1e-14 * longest2;
}

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
        if (!is_finite_float(position))
            fail("the position ({}, {}, {}) is too large", position.x, position.y, position.z);
        result.mesh.positions.push_back(position);
    }
    if (!geometry.normals.empty())
        result.mesh.normals = unit_normals(geometry);
    result.mesh.uv = geometry.uv;
    for (std::size_t i = 0; i < geometry.triangles.size(); ++i) {
        const auto& [a, b, c] = geometry.triangles[i];
        if (is_degenerate(geometry.positions[a], geometry.positions[b], geometry.positions[c])) {
            ++result.degenerate;
        } else {
            result.mesh.triangles.push_back(geometry.triangles[i]);
            result.patches.push_back(geometry.patches[i]);
        }
    }
    return result;
}

V3d coordinate_origin(const std::vector<Shape>& shapes) {
    Imath::Box3d box;
    for (const Shape& shape : shapes)
        box.extendBy(bounds(shape.mesh.positions));
    if (box.isEmpty() || box.center().length() <= box.size().length())
        return V3d(0.0);
    return box.center();
}

double relative_spacing(const std::vector<V3d>& positions, const V3d& origin) {
    const Imath::Box3d box = bounds(positions);
    const auto largest = [](const V3d& a, const V3d& b) {
        double coordinate = 0.0;
        for (int axis = 0; axis < 3; ++axis)
            coordinate = std::max({coordinate, std::abs(a[axis]), std::abs(b[axis])});
        return coordinate;
    };
    const double spacing =
        std::max(0x1p-23 * largest(box.min - origin, box.max - origin), 0x1p-52 * largest(box.min, box.max));
    return spacing / box.size().length();
}

double area(const Mesh& mesh) {
    double sum = 0.0;
    for (const auto& triangle : mesh.triangles)
        sum += 0.5 * area_normal(mesh.positions, triangle).length();
    return sum;
}

Shape parallelogram(const V3d& corner, const V3d& edge1, const V3d& edge2, int material, int area_light) {
    Shape shape;
    shape.mesh.positions = {corner, corner + edge1, corner + edge1 + edge2, corner + edge2};
    shape.mesh.triangles = {{0U, 1U, 2U}, {0U, 2U, 3U}};
    shape.material = material;
    shape.area_light = area_light;
    return shape;
}

} // namespace tristim
