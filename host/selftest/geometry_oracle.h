#pragma once

#include "bvh/bvh.h"

#include <cstdint>
#include <random>

namespace tristim::selftest {

/// A triangle of single-precision vertices.
struct Corners {
    V3f v0, v1, v2;

    V3d normal() const; ///< unit; zero if the triangle has no area
};

/// How far a ray's answer is from a triangle's true place: the distance between the point at t on the ray and the one
/// that u and v give on the triangle; for a miss, how deep inside the triangle the ray passes in truth. In units of the
/// largest coordinate of a vertex as the ray's origin sees it. It is what vertices would have to move for the answer to
/// be right, so rounding explains some units of 2^-24 whatever the triangle's shape and the ray's angle.
double hit_error(const Corners& triangle, const Ray& ray, const RayHit& hit);

/// Uniform numbers that owe nothing to the kernels'.
class Random {
  public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}
    double operator()(double low = 0.0, double high = 1.0) {
        return low + (high - low) * (static_cast<double>(engine_()) * 0x1p-32);
    }
    std::size_t index(std::size_t count) { return engine_() % count; }
    V3d in_cube(double half) {
        const double x = (*this)(-half, half), y = (*this)(-half, half);
        return {x, y, (*this)(-half, half)};
    }
    V3d direction();

  private:
    std::mt19937 engine_;
};

V3f to_float(const V3d& v);

/// A ray from `origin` through `target`, both as they are in single precision.
Ray ray_through(const V3f& origin, const V3f& target);
Ray ray_along(const V3f& origin, const V3d& direction);

/// Meshes of the shape that `name` says, as large as `scale` and around `centre`, that are closed and convex; the
/// triangles face outwards and share their vertices to the bit.
TriangleSoup closed_mesh(const std::string& name, double scale, const V3d& centre);

void add(TriangleSoup& soup, const Corners& corners);
Corners corners_of(const TriangleSoup& soup, std::size_t triangle);

} // namespace tristim::selftest
