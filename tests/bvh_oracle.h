#pragma once

// Ray-triangle intersection in double precision by brute force, with bounds on what float arithmetic may answer
// instead.

#include "bvh/bvh.h"

#include <Imath/ImathVec.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

namespace tristim::bvh_test {

constexpr double unit_roundoff = 0x1p-24; ///< of float

inline V3d vertex(const TriangleSoup& soup, std::size_t triangle, std::size_t corner) {
    const V3f& v = corner == 0 ? soup.v0[triangle] : corner == 1 ? soup.v1[triangle] : soup.v2[triangle];
    return V3d(v);
}

inline void add(TriangleSoup& soup, const V3f& a, const V3f& b, const V3f& c) {
    soup.v0.push_back(a);
    soup.v1.push_back(b);
    soup.v2.push_back(c);
}

inline Ray make_ray(const V3f& origin, const V3f& direction, float t_max = std::numeric_limits<float>::infinity()) {
    return {origin.x, origin.y, origin.z, t_max, direction.x, direction.y, direction.z, 0.0f};
}

class Random {
  public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}
    float operator()(float low = 0.0f, float high = 1.0f) {
        return low + (high - low) * static_cast<float>(engine_() >> 8) * 0x1p-24f;
    }
    std::size_t index(std::size_t count) { return engine_() % count; }
    V3f in_cube(float half) { return {(*this)(-half, half), (*this)(-half, half), (*this)(-half, half)}; }
    V3f direction() {
        for (;;) {
            const V3f v = in_cube(1.0f);
            if (v.length2() > 0.01f && v.length2() <= 1.0f)
                return v.normalized();
        }
    }

  private:
    std::mt19937 engine_;
};

/// How a triangle stands to a ray.
struct Standing {
    bool possible = false; ///< float arithmetic may find a hit
    bool certain = false;  ///< it must
    double t = 0.0;
    double t_error = 0.0; ///< bound on the float result's error
};

/// Woop, Benthin & Wald 2013's test in double. With u = 2^-24, M the largest coordinate and L the longest projected
/// distance of a vertex from the ray:
/// - translating and shearing moves a vertex by at most 6u·2M across the ray; an edge function that is off by its
///   products' rounding, 3uL², moves the edge by at most 3uL²/edge ≤ 6uM·(L/M)(L/edge), and where that matters the ray
///   passes between the edge's ends, so L ≤ edge for both: 3uL. Together less than 12uM + 3uL.
/// - t is off by the moved vertices times the triangle's slope L²/|det|, by the edge functions' rounding,
/// 3·3uL²·Z/|det|
///   where Z bounds the vertices' spread along the ray, and by a few roundings of sums over M and of t itself.
inline Standing stand(const TriangleSoup& soup, std::size_t triangle, const Ray& ray) {
    const V3d origin(ray.origin_x, ray.origin_y, ray.origin_z);
    const V3d direction(ray.direction_x, ray.direction_y, ray.direction_z);
    unsigned z = 0;
    for (unsigned axis = 1; axis < 3; ++axis)
        if (std::abs(direction[static_cast<int>(axis)]) > std::abs(direction[static_cast<int>(z)]))
            z = axis;
    const int kz = static_cast<int>(z);
    const int kx = (kz + 1) % 3;
    const int ky = (kz + 2) % 3;
    std::array<V3d, 3> p;
    double largest = std::max({std::abs(origin.x), std::abs(origin.y), std::abs(origin.z)});
    double radius = 0.0;
    for (std::size_t corner = 0; corner < 3; ++corner) {
        const V3d v = vertex(soup, triangle, corner);
        largest = std::max({largest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
        const V3d a = v - origin;
        p[corner] = {a[kx] - direction[kx] / direction[kz] * a[kz], a[ky] - direction[ky] / direction[kz] * a[kz],
                     a[kz] / direction[kz]};
        radius = std::max(radius, std::hypot(p[corner].x, p[corner].y));
    }
    std::array<double, 3> edge{}; // opposite to the corner of the same number
    std::array<double, 3> distance{};
    double determinant = 0.0;
    double t_sum = 0.0;
    for (std::size_t corner = 0; corner < 3; ++corner) {
        const V3d& b = p[(corner + 1) % 3];
        const V3d& c = p[(corner + 2) % 3];
        edge[corner] = c.x * b.y - c.y * b.x;
        const double length = std::hypot(b.x - c.x, b.y - c.y);
        distance[corner] = length > 0.0 ? edge[corner] / length : 0.0;
        determinant += edge[corner];
        t_sum += edge[corner] * p[corner].z;
    }
    const double u = unit_roundoff;
    const double across = 12.0 * u * largest + 3.0 * u * radius;
    const auto [low, high] = std::minmax_element(distance.begin(), distance.end());
    Standing standing;
    const double size = std::abs(determinant);
    standing.t = size > 0.0 ? t_sum / determinant : std::numeric_limits<double>::quiet_NaN();
    const auto [front, back] = std::minmax({p[0].z, p[1].z, p[2].z});
    const double spread = back - front;
    standing.t_error = size > 0.0 ? u * (8.0 * std::abs(standing.t) + 12.0 * largest) +
                                        (12.0 * u * largest * radius + 9.0 * u * radius * radius) * spread / size
                                  : std::numeric_limits<double>::infinity();
    standing.possible = *low >= -across || *high <= across;
    standing.certain = *low > across || *high < -across;
    const double t_max = ray.t_max;
    if (size > 0.0) {
        standing.possible =
            standing.possible && standing.t + standing.t_error > 0.0 && standing.t - standing.t_error < t_max;
        standing.certain =
            standing.certain && standing.t - standing.t_error > 0.0 && standing.t + standing.t_error < t_max;
    }
    return standing;
}

/// Empty if the hit is one that float arithmetic may give for this ray, else what is wrong with it.
inline std::string check_hit(const TriangleSoup& soup, const Ray& ray, const RayHit& hit) {
    if (hit.triangle < -1 || hit.triangle >= static_cast<int>(soup.v0.size()))
        return "no such triangle: " + std::to_string(hit.triangle);
    if (hit.triangle >= 0) {
        const Standing own = stand(soup, static_cast<std::size_t>(hit.triangle), ray);
        if (!own.possible)
            return "triangle " + std::to_string(hit.triangle) + " is not hit";
        if (std::abs(own.t - hit.t) > own.t_error)
            return "t is " + std::to_string(hit.t) + ", should be " + std::to_string(own.t);
    }
    for (std::size_t triangle = 0; triangle < soup.v0.size(); ++triangle) {
        const Standing other = stand(soup, triangle, ray);
        if (other.certain && other.t + other.t_error < (hit.triangle >= 0 ? hit.t : ray.t_max))
            return "triangle " + std::to_string(triangle) + " is hit at " + std::to_string(other.t) + ", before " +
                   std::to_string(hit.t);
    }
    return "";
}

/// A closed mesh around the origin, star-shaped, with radii between 0.8 and 1.2: the sphere over an octahedron, each
/// triangle cut in four `levels` times. Vertices that triangles share are equal to the bit.
inline TriangleSoup bumpy_sphere(int levels, const V3f& centre, float scale) {
    std::vector<std::array<V3f, 3>> faces;
    for (const float x : {-1.0f, 1.0f})
        for (const float y : {-1.0f, 1.0f})
            for (const float z : {-1.0f, 1.0f})
                faces.push_back({V3f(x, 0, 0), V3f(0, y, 0), V3f(0, 0, z)});
    for (int level = 0; level < levels; ++level) {
        std::vector<std::array<V3f, 3>> finer;
        for (const auto& [a, b, c] : faces) {
            const V3f ab = (a + b).normalized();
            const V3f bc = (b + c).normalized();
            const V3f ca = (c + a).normalized();
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        faces = std::move(finer);
    }
    const auto place = [&](const V3f& v) {
        const float radius = 1.0f + 0.2f * std::sin(9.0f * v.x) * std::sin(7.0f * v.y) * std::sin(8.0f * v.z);
        return centre + scale * radius * v;
    };
    TriangleSoup soup;
    for (const auto& [a, b, c] : faces)
        add(soup, place(a), place(b), place(c));
    return soup;
}

} // namespace tristim::bvh_test
