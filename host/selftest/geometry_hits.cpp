#include "selftest/geometry_measures.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace tristim::selftest {
namespace {

/// Rays, each with the triangle that it is meant for.
struct Probes {
    std::vector<Corners> triangles;
    std::vector<Ray> rays;
};

/// A point of a triangle or near it: corners, edges, within and without.
V3d aim(const Corners& triangle, Random& random) {
    double u = random(-0.1, 1.1), v = random(-0.1, 1.1);
    if (u + v > 1.1) {
        u = 1.0 - u;
        v = 1.0 - v;
    }
    switch (random.index(8)) {
    case 0:
        u = 0.0;
        break;
    case 1:
        u = 0.0;
        v = 0.0;
        break;
    case 2:
        v = 1.0 - u;
        break;
    default:
        break;
    }
    return (1.0 - u - v) * V3d(triangle.v0) + u * V3d(triangle.v1) + v * V3d(triangle.v2);
}

void add_errors(const GeometryKernels& kernels, const Probes& probes, double parameter, const char* name,
                Measurement& found) {
    BvhBlocks leaves = empty_leaves(probes.rays.size(), kernels.device().tuning.bvh_width);
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        const Corners& c = probes.triangles[i];
        set_triangle(leaves, i, i % leaves.width(), {c.v0, c.v1, c.v2}, 0);
    }
    const std::vector<RayHit> hits = kernels.hit_leaves(leaves, probes.rays);
    for (std::size_t i = 0; i < hits.size(); ++i) {
        const Corners& c = probes.triangles[i];
        const Ray& ray = probes.rays[i];
        found.add(parameter, hit_error(c, ray, hits[i]), [&] {
            return fmt::format("{} {:.3g}: from ({}, {}, {}) along ({}, {}, {}), triangle ({}, {}, {}), ({}, {}, {}), "
                               "({}, {}, {}): {} at t = {}, u = {}, v = {}",
                               name, parameter, ray.origin_x, ray.origin_y, ray.origin_z, ray.direction_x,
                               ray.direction_y, ray.direction_z, c.v0.x, c.v0.y, c.v0.z, c.v1.x, c.v1.y, c.v1.z, c.v2.x,
                               c.v2.y, c.v2.z, hits[i].triangle < 0 ? "missed" : "hit", hits[i].t, hits[i].u,
                               hits[i].v);
        });
    }
}

/// Triangles of random vertices about a centre, seen from about as far as they are large.
Probes random_probes(std::size_t count, double scale, const V3d& centre, Random& random) {
    Probes probes;
    for (std::size_t i = 0; i < count; ++i) {
        const auto vertex = [&] { return to_float(centre + random.in_cube(scale)); };
        const Corners triangle{vertex(), vertex(), vertex()};
        const V3f origin = to_float(centre + random.in_cube(2.0 * scale));
        probes.triangles.push_back(triangle);
        probes.rays.push_back(ray_through(origin, to_float(aim(triangle, random))));
    }
    return probes;
}

constexpr std::size_t probes_per_value = 8000;

} // namespace

Measurement hits_by_scale(const GeometryKernels& kernels, const Setting& setting) {
    Measurement found;
    Random random(1);
    for (int exponent = -6; exponent <= 6; ++exponent) {
        const double scale = std::pow(10.0, exponent);
        add_errors(kernels, random_probes(inputs(setting, probes_per_value, 16), scale, V3d(0.0), random), scale,
                   "scale", found);
    }
    return found;
}

Measurement hits_by_distance(const GeometryKernels& kernels, const Setting& setting) {
    Measurement found;
    Random random(2);
    for (double distance = 0.1; distance < 2e6; distance *= 10.0) {
        const V3d centre = distance * random.direction();
        add_errors(kernels, random_probes(inputs(setting, probes_per_value, 16), 1.0, centre, random), distance,
                   "distance", found);
    }
    return found;
}

Measurement hits_by_aspect(const GeometryKernels& kernels, const Setting& setting) {
    Measurement found;
    Random random(3);
    for (double aspect = 1.0; aspect < 2e7; aspect *= 10.0) {
        Probes probes;
        const std::size_t count = inputs(setting, probes_per_value, 16);
        for (std::size_t i = 0; i < count; ++i) {
            const V3d along = random.direction();
            const V3d across = along.cross(random.direction()).normalized() / aspect;
            const V3d v0 = random.in_cube(0.5);
            // A needle with its short side at one end, or a flat one whose third vertex is in the middle.
            const double third = i % 2 == 0 ? 1.0 : random();
            const Corners triangle{to_float(v0), to_float(v0 + along), to_float(v0 + third * along + across)};
            probes.triangles.push_back(triangle);
            probes.rays.push_back(ray_through(to_float(v0 + random.in_cube(2.0)), to_float(aim(triangle, random))));
        }
        add_errors(kernels, probes, aspect, "aspect ratio", found);
    }
    return found;
}

Measurement hits_by_cosine(const GeometryKernels& kernels, const Setting& setting) {
    Measurement found;
    Random random(4);
    for (double cosine = 1.0; cosine > 1e-8; cosine *= 0.1) {
        Probes probes;
        const std::size_t count = inputs(setting, probes_per_value, 16);
        while (probes.rays.size() < count) {
            const auto vertex = [&] { return to_float(random.in_cube(1.0)); };
            const Corners triangle{vertex(), vertex(), vertex()};
            const V3d target = aim(triangle, random);
            const V3d normal = triangle.normal();
            const V3d tangent = normal.cross(random.direction()).normalized();
            const double sine = std::sqrt(1.0 - cosine * cosine);
            const V3f origin = to_float(target + random(0.1, 2.0) * (cosine * normal + sine * tangent));
            probes.triangles.push_back(triangle);
            probes.rays.push_back(ray_through(origin, to_float(target)));
        }
        add_errors(kernels, probes, cosine, "cosine", found);
    }
    return found;
}

} // namespace tristim::selftest
