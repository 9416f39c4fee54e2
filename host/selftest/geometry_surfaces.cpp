#include "selftest/geometry_measures.h"

#include "render/flat_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace tristim::selftest {
namespace {

constexpr std::size_t rays_per_value = 16384;

V3d perpendicular(const V3d& n, Random& random) {
    return n.cross(random.direction()).normalized();
}

/// Adds a batch of rays of which some went wrong; Measurement counts each ray as an input.
void add_count(std::size_t wrong, std::size_t rays, double parameter, const std::string& what, Measurement& found) {
    found.add(parameter, static_cast<double>(wrong),
              [&] { return fmt::format("{} of {} rays, {}", wrong, rays, what); });
    found.inputs += rays - 1;
}

/// Somewhere inside a convex mesh; one in four on a grid of eighths, so that rays to vertices run along axes and
/// diagonals exactly.
V3d inside(double scale, Random& random) {
    V3d p = random.in_cube(0.4);
    if (random.index(4) == 0)
        p = V3d(std::round(8.0 * p.x), std::round(8.0 * p.y), std::round(8.0 * p.z)) / 8.0;
    return scale * p;
}

/// A vertex, a point of an edge or one of the whole triangle.
V3d target_on(const Corners& c, Random& random) {
    const V3d v0(c.v0), v1(c.v1), v2(c.v2);
    const double s = random();
    switch (random.index(3)) {
    case 0:
        return random.index(2) == 0 ? v0 : v1;
    case 1:
        return (1.0 - s) * v0 + s * (random.index(2) == 0 ? v1 : v2);
    default:
        return (1.0 - s) * v0 + s * (v1 + random() * (v2 - v1));
    }
}

constexpr std::array<const char*, 4> closed_meshes{"box", "divided box", "icosphere", "spindle"};

Measurement count_leaks(const GeometryKernels& kernels, const Setting& setting, const char* parameter,
                        const std::vector<double>& values) {
    const bool by_scale = parameter == std::string("scale");
    Measurement found;
    Random random(5);
    for (const double value : values) {
        for (const char* name : closed_meshes) {
            const double scale = by_scale ? value : 1.0;
            const V3d centre = by_scale ? V3d(0.0) : value * random.direction();
            const GeometryMesh mesh(kernels.device(), closed_mesh(name, scale, centre));
            const std::size_t rays = inputs(setting, rays_per_value, 64);
            add_count(leaks(kernels, mesh, centre, scale, rays, random), rays, value,
                      fmt::format("{}, {} {:.3g}", name, parameter, value), found);
        }
    }
    return found;
}

/// A rectangle between two larger ones.
struct Sandwich {
    V3d normal, along, across, centre;
    double half_along, half_across, gap;
    TriangleSoup soup; ///< triangles 0 and 1 are the rectangle

    Sandwich(const LeavingCase& c, Random& random)
        : normal(random.direction()), along(perpendicular(normal, random)), across(normal.cross(along)),
          centre(c.scale * c.distance * random.direction()), half_along(c.scale), half_across(c.scale / c.aspect),
          gap(c.gap * 0x1p-24 * (3.0 + c.distance) * c.scale) {
        add_rectangle(0.0, half_along, half_across);
        for (const double side : {-gap, gap})
            add_rectangle(side, 2.0 * c.scale, 2.0 * c.scale);
    }

    void add_rectangle(double height, double a, double b) {
        const auto corner = [&](double x, double y) {
            return to_float(centre + x * a * along + y * b * across + height * normal);
        };
        const V3f first = corner(-1, -1), third = corner(1, 1);
        add(soup, {first, corner(1, -1), third});
        add(soup, {first, third, corner(-1, 1)});
    }
};

V3d leaving_direction(const V3d& side, double cosine, Random& random) {
    if (cosine < 0.0) {
        const V3d d = random.direction();
        return d.dot(side) < 0.0 ? -d : d;
    }
    return cosine * side + std::sqrt(std::max(1.0 - cosine * cosine, 0.0)) * perpendicular(side, random);
}

cl_float4 direction_of(const V3d& d) {
    const V3f f = to_float(d.normalized());
    return {{f.x, f.y, f.z, 0.0F}};
}

Measurement count_leaving(const GeometryKernels& kernels, const Setting& setting, const char* parameter,
                          const std::vector<double>& values, double LeavingCase::*varied) {
    Measurement found;
    Random random(6);
    for (const double value : values) {
        LeavingCase c;
        c.*varied = value;
        const std::size_t tilts = 8;
        const std::size_t rays = inputs(setting, rays_per_value / tilts, 16);
        std::size_t wrong = 0;
        for (std::size_t tilt = 0; tilt < tilts; ++tilt)
            wrong += leaving_errors(kernels, c, rays, random);
        add_count(wrong, rays * tilts, value, fmt::format("{} {:.3g}", parameter, value), found);
    }
    return found;
}

std::vector<double> powers_of_ten(int low, int high) {
    std::vector<double> values;
    for (int exponent = low; exponent <= high; ++exponent)
        values.push_back(std::pow(10.0, exponent));
    return values;
}

} // namespace

std::size_t leaks(const GeometryKernels& kernels, const GeometryMesh& mesh, const V3d& centre, double scale,
                  std::size_t count, Random& random) {
    std::vector<Ray> rays;
    rays.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Corners c = corners_of(mesh.soup, random.index(mesh.soup.v0.size()));
        rays.push_back(ray_through(to_float(centre + inside(scale, random)), to_float(target_on(c, random))));
    }
    std::size_t leaked = 0;
    const std::vector<std::int32_t> occluded = kernels.any(mesh, rays);
    const std::vector<RayHit> hits = kernels.closest(mesh, rays);
    for (std::size_t i = 0; i < count; ++i)
        leaked += hits[i].triangle < 0 || occluded[i] == 0 ? 1 : 0;
    return leaked;
}

Measurement leaks_by_scale(const GeometryKernels& kernels, const Setting& setting) {
    return count_leaks(kernels, setting, "scale", powers_of_ten(-6, 6));
}

Measurement leaks_by_distance(const GeometryKernels& kernels, const Setting& setting) {
    return count_leaks(kernels, setting, "distance", powers_of_ten(0, 4));
}

std::size_t leaving_errors(const GeometryKernels& kernels, const LeavingCase& c, std::size_t count, Random& random) {
    const Sandwich s(c, random);
    TriangleSoup alone;
    for (std::size_t i = 0; i < 2; ++i)
        add(alone, corners_of(s.soup, i));
    std::vector<Ray> arriving;
    std::vector<cl_float4> directions;
    for (std::size_t i = 0; i < count; ++i) {
        const V3d target =
            s.centre + random(-0.99, 0.99) * s.half_along * s.along + random(-0.99, 0.99) * s.half_across * s.across;
        const V3d side = random.index(2) == 0 ? s.normal : -s.normal;
        // Steep, since those that come along a needle's plane may pass it by.
        const V3d from = target + c.scale * (side + random.in_cube(0.5));
        arriving.push_back(ray_along(to_float(from), target - from));
        directions.push_back(
            direction_of(leaving_direction(random.index(2) == 0 ? s.normal : -s.normal, c.cosine, random)));
    }
    const GeometryMesh rectangle(kernels.device(), alone);
    std::vector<RayHit> hits = kernels.closest(rectangle, arriving);
    // Rays at a needle narrower than the spacing of floats may miss: they are no test of leaving it.
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
        if (hits[i].triangle < 0)
            continue;
        hits[kept] = hits[i];
        directions[kept++] = directions[i];
    }
    hits.resize(kept);
    directions.resize(kept);
    if (kept == 0)
        return 0;
    const std::vector<Ray> leaving = kernels.leave(rectangle, hits, directions);
    const std::vector<RayHit> met = kernels.closest(GeometryMesh(kernels.device(), s.soup), leaving);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < kept; ++i) {
        const V3d d(directions[i].s[0], directions[i].s[1], directions[i].s[2]);
        // More grazing rays may pass the neighbour's edge.
        const bool must_meet = std::abs(d.dot(s.normal)) * c.scale >= 2.0 * s.gap;
        const bool meets_itself = met[i].triangle >= 0 && met[i].triangle < 2;
        wrong += meets_itself || (met[i].triangle < 0 && must_meet) ? 1 : 0;
    }
    return wrong;
}

Measurement leaving_by_scale(const GeometryKernels& kernels, const Setting& setting) {
    return count_leaving(kernels, setting, "scale", powers_of_ten(-6, 6), &LeavingCase::scale);
}

Measurement leaving_by_distance(const GeometryKernels& kernels, const Setting& setting) {
    return count_leaving(kernels, setting, "distance", powers_of_ten(-1, 4), &LeavingCase::distance);
}

Measurement leaving_by_cosine(const GeometryKernels& kernels, const Setting& setting) {
    return count_leaving(kernels, setting, "cosine", powers_of_ten(-7, 0), &LeavingCase::cosine);
}

Measurement leaving_by_aspect(const GeometryKernels& kernels, const Setting& setting) {
    return count_leaving(kernels, setting, "aspect ratio", powers_of_ten(0, 6), &LeavingCase::aspect);
}

Measurement leaving_meshes(const GeometryKernels& kernels, const Setting& setting) {
    Measurement found;
    Random random(7);
    for (const double distance : {0.0, 1.0, 10.0, 100.0}) {
        const V3d centre = distance * random.direction();
        const GeometryMesh mesh(kernels.device(), closed_mesh("icosphere", 1.0, centre));
        const std::size_t rays = inputs(setting, rays_per_value, 64);
        std::vector<Ray> arriving;
        std::vector<cl_float4> directions;
        std::vector<bool> outwards;
        for (std::size_t i = 0; i < rays; ++i) {
            const Corners c = corners_of(mesh.soup, random.index(mesh.soup.v0.size()));
            const V3d target = target_on(c, random);
            arriving.push_back(ray_through(to_float(centre + inside(1.0, random)), to_float(target)));
            outwards.push_back(random.index(2) == 0);
            const V3d inwards = centre + inside(1.0, random) - target;
            directions.push_back(direction_of(outwards.back() ? -inwards : inwards));
        }
        const std::vector<RayHit> hits = kernels.closest(mesh, arriving);
        const std::vector<RayHit> met = kernels.closest(mesh, kernels.leave(mesh, hits, directions));
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < rays; ++i)
            wrong += hits[i].triangle < 0 || outwards[i] != (met[i].triangle < 0) ? 1 : 0;
        add_count(wrong, rays, distance, fmt::format("distance {:.3g}", distance), found);
    }
    return found;
}

std::size_t shadow_errors(const GeometryKernels& kernels, const ShadowCase& c, std::size_t count, Random& random) {
    // The receiver and the light about face each other; the world's origin is on one of them.
    const V3d towards = random.direction();
    const double receiver_size = c.origin_on_light ? c.light_size * c.distance : c.light_size;
    const V3d to_light = c.distance * c.light_size * towards;
    const V3d tilt = (towards + random.in_cube(0.5)).normalized();
    const auto triangle = [&](const V3d& centre, const V3d& normal, double size) {
        const V3d s = size * perpendicular(normal, random);
        const V3d t = normal.cross(s);
        return Corners{to_float(centre - s - t), to_float(centre + s - t), to_float(centre + t)};
    };
    const Corners receiver = triangle(c.origin_on_light ? -to_light : V3d(0.0), tilt, 0.25 * receiver_size);
    const Corners emitter = triangle(c.origin_on_light ? V3d(0.0) : to_light,
                                     (random.in_cube(0.5) - towards).normalized(), 0.25 * c.light_size);
    TriangleSoup both, alone;
    add(both, receiver);
    add(both, emitter);
    add(alone, receiver);
    const GeometryMesh mesh(kernels.device(), both);
    const SceneLight light = flat_area_light(emitter.v0, emitter.v1, emitter.v2);

    std::vector<Ray> arriving;
    std::vector<cl_float4> u;
    for (std::size_t i = 0; i < count; ++i) {
        const V3d target = V3d(receiver.v0) + random(0.05, 0.5) * (V3d(receiver.v1) - V3d(receiver.v0)) +
                           random(0.05, 0.45) * (V3d(receiver.v2) - V3d(receiver.v0));
        arriving.push_back(
            ray_through(to_float(target + receiver_size * (tilt + random.in_cube(0.3))), to_float(target)));
        u.push_back({{static_cast<float>(random()), static_cast<float>(random()), static_cast<float>(random()),
                      static_cast<float>(random())}});
    }
    const std::vector<RayHit> hits = kernels.closest(GeometryMesh(kernels.device(), alone), arriving);
    std::size_t wrong = 0;
    for (const RayHit& hit : hits)
        wrong += hit.triangle < 0 ? 1 : 0;
    for (const std::int32_t occluded : kernels.any(mesh, kernels.shadows(mesh, hits, light, u)))
        wrong += occluded != 0 ? 1 : 0;
    for (const RayHit& hit : kernels.closest(mesh, kernels.emitted(light, u)))
        wrong += hit.triangle == 1 ? 1 : 0;
    return wrong;
}

Measurement shadows_by_distance(const GeometryKernels& kernels, const Setting& setting) {
    Measurement found;
    Random random(8);
    for (const double distance : powers_of_ten(0, 6)) {
        std::size_t wrong = 0;
        std::size_t rays = 0;
        for (const double light_size : {1e-3, 1.0, 1e3}) {
            for (const bool origin_on_light : {false, true}) {
                if (!origin_on_light && distance > 1e3)
                    continue; // so small and far away, the light itself is little more than rounding
                const std::size_t count = inputs(setting, rays_per_value / 4, 32);
                wrong += shadow_errors(kernels, {light_size, distance, origin_on_light}, count, random);
                rays += 2 * count;
            }
        }
        add_count(wrong, rays, distance, fmt::format("distance {:.3g}", distance), found);
    }
    return found;
}

} // namespace tristim::selftest
