#include "selftest/geometry_oracle.h"

#include "base/error.h"
#include "meshes/icosphere.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace tristim::selftest {
namespace {

using std::numbers::pi;

V3d origin_of(const Ray& ray) {
    return {ray.origin_x, ray.origin_y, ray.origin_z};
}
V3d direction_of(const Ray& ray) {
    return {ray.direction_x, ray.direction_y, ray.direction_z};
}

/// How deep within a triangle a line passes, seen along it: negative outside.
double depth_inside(const Corners& triangle, const V3d& origin, const V3d& direction) {
    const V3d d = direction.normalized();
    const V3d other = std::abs(d.x) < 0.5 ? V3d(1.0, 0.0, 0.0) : V3d(0.0, 1.0, 0.0);
    const V3d s = other.cross(d).normalized();
    const V3d t = d.cross(s);
    std::array<std::array<double, 2>, 3> seen{};
    const std::array<V3f, 3> vertices{triangle.v0, triangle.v1, triangle.v2};
    for (std::size_t i = 0; i < 3; ++i) {
        const V3d v = V3d(vertices[i]) - origin;
        seen[i] = {v.dot(s), v.dot(t)};
    }
    double least = std::numeric_limits<double>::infinity();
    double most = -least;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto& a = seen[i];
        const auto& b = seen[(i + 1) % 3];
        const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
        const double distance = length > 0.0 ? (a[0] * b[1] - a[1] * b[0]) / length : 0.0;
        least = std::min(least, distance);
        most = std::max(most, distance);
    }
    return std::max(least, -most); // one of them, for either orientation
}

/// A box from -1 to 1 whose sides are n × n squares.
TriangleSoup box(int n, double scale, const V3d& centre) {
    TriangleSoup soup;
    for (int axis = 0; axis < 3; ++axis) {
        for (const int side : {-1, 1}) {
            const auto corner = [&](int i, int j) {
                V3d v;
                v[axis] = side;
                v[(axis + 1) % 3] = -1.0 + 2.0 * i / n;
                v[(axis + 2) % 3] = side * (-1.0 + 2.0 * j / n); // so that both sides face outwards
                return to_float(centre + scale * v);
            };
            for (int i = 0; i < n; ++i) {
                for (int j = 0; j < n; ++j) {
                    add(soup, {corner(i, j), corner(i + 1, j), corner(i + 1, j + 1)});
                    add(soup, {corner(i, j), corner(i + 1, j + 1), corner(i, j + 1)});
                }
            }
        }
    }
    return soup;
}

/// Two cones base to base: slivers that meet at two points.
TriangleSoup spindle(int segments, double scale, const V3d& centre) {
    TriangleSoup soup;
    const auto rim = [&](int i) {
        const double angle = 2.0 * pi * (i % segments) / segments;
        return to_float(centre + scale * V3d(std::cos(angle), std::sin(angle), 0.0));
    };
    const V3f top = to_float(centre + V3d(0.0, 0.0, scale));
    const V3f bottom = to_float(centre - V3d(0.0, 0.0, scale));
    for (int i = 0; i < segments; ++i) {
        add(soup, {top, rim(i), rim(i + 1)});
        add(soup, {bottom, rim(i + 1), rim(i)});
    }
    return soup;
}

} // namespace

V3d Corners::normal() const {
    return (V3d(v1) - V3d(v0)).cross(V3d(v2) - V3d(v0)).normalized();
}

double hit_error(const Corners& triangle, const Ray& ray, const RayHit& hit) {
    const V3d origin = origin_of(ray);
    const V3d direction = direction_of(ray);
    double largest = 0.0;
    for (const V3f& v : {triangle.v0, triangle.v1, triangle.v2}) {
        const V3d from_origin = V3d(v) - origin;
        largest = std::max({largest, std::abs(from_origin.x), std::abs(from_origin.y), std::abs(from_origin.z)});
    }
    if (hit.triangle >= 0) {
        const double u = hit.u, v = hit.v;
        const V3d on_triangle = (1.0 - u - v) * V3d(triangle.v0) + u * V3d(triangle.v1) + v * V3d(triangle.v2);
        return (origin + static_cast<double>(hit.t) * direction - on_triangle).length() / largest;
    }
    const V3d n = triangle.normal();
    const bool ahead = n.dot(V3d(triangle.v0) - origin) * n.dot(direction) > 0.0;
    return ahead ? std::max(depth_inside(triangle, origin, direction), 0.0) / largest : 0.0;
}

V3d Random::direction() {
    for (;;) {
        const V3d v = in_cube(1.0);
        if (v.length2() > 0.01 && v.length2() <= 1.0)
            return v.normalized();
    }
}

Ray ray_along(const V3f& origin, const V3d& direction) {
    const V3f d = to_float(direction.normalized());
    return {origin.x, origin.y, origin.z, std::numeric_limits<float>::infinity(), d.x, d.y, d.z, 0.0F};
}

V3f to_float(const V3d& v) {
    return V3f(static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z));
}

Ray ray_through(const V3f& origin, const V3f& target) {
    return ray_along(origin, V3d(target) - V3d(origin));
}

TriangleSoup closed_mesh(const std::string& name, double scale, const V3d& centre) {
    if (name == "box")
        return box(1, scale, centre);
    if (name == "divided box")
        return box(16, scale, centre);
    if (name == "spindle")
        return spindle(1024, scale, centre);
    if (name != "icosphere")
        fail("there is no mesh \"{}\"", name);
    TriangleSoup soup;
    const Icosphere sphere = make_icosphere(3);
    for (const auto& [a, b, c] : sphere.triangles)
        add(soup, {to_float(centre + scale * sphere.positions[a]), to_float(centre + scale * sphere.positions[b]),
                   to_float(centre + scale * sphere.positions[c])});
    return soup;
}

void add(TriangleSoup& soup, const Corners& corners) {
    soup.v0.push_back(corners.v0);
    soup.v1.push_back(corners.v1);
    soup.v2.push_back(corners.v2);
}

Corners corners_of(const TriangleSoup& soup, std::size_t triangle) {
    return {soup.v0[triangle], soup.v1[triangle], soup.v2[triangle]};
}

} // namespace tristim::selftest
