#include "meshes/triangulate.h"

#include <algorithm>
#include <numeric>

namespace tristim {

namespace {

using Imath::V3d;
using Imath::V3f;

/// Twice the polygon's vector area (Newell's formula).
V3d polygon_normal(const std::vector<V3f>& corners) {
    V3d sum(0.0);
    const V3d origin(corners.front());
    for (std::size_t i = 0; i < corners.size(); ++i)
        sum += (V3d(corners[i]) - origin).cross(V3d(corners[(i + 1) % corners.size()]) - origin);
    return sum;
}

double turn(const V3d& a, const V3d& b, const V3d& c, const V3d& normal) {
    return (b - a).cross(c - b).dot(normal);
}

/// True if the polygon bends outward at corner `at` of the ring and no other corner lies in the triangle there.
bool is_ear(const std::vector<V3f>& corners, const std::vector<std::size_t>& ring, std::size_t at, const V3d& normal) {
    const std::size_t n = ring.size();
    const V3d a(corners[ring[(at + n - 1) % n]]), b(corners[ring[at]]), c(corners[ring[(at + 1) % n]]);
    if (turn(a, b, c, normal) <= 0.0)
        return false;
    for (std::size_t i = 2; i + 1 < n; ++i) {
        const V3d p(corners[ring[(at + i) % n]]);
        if (turn(a, b, p, normal) >= 0.0 && turn(b, c, p, normal) >= 0.0 && turn(c, a, p, normal) >= 0.0)
            return false;
    }
    return true;
}

} // namespace

std::vector<std::array<std::size_t, 3>> triangulate(const std::vector<V3f>& corners) {
    std::vector<std::array<std::size_t, 3>> triangles;
    const V3d normal = polygon_normal(corners);
    std::vector<std::size_t> ring(corners.size());
    std::iota(ring.begin(), ring.end(), std::size_t{0});
    while (ring.size() > 3) {
        std::size_t ear = 0;
        while (ear < ring.size() && !is_ear(corners, ring, ear, normal))
            ++ear;
        // Collinear or self-intersecting corners leave no ear: cut off any one.
        if (ear == ring.size())
            ear = 1;
        const std::size_t n = ring.size();
        triangles.push_back({ring[(ear + n - 1) % n], ring[ear], ring[(ear + 1) % n]});
        ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    triangles.push_back({ring[0], ring[1], ring[2]});
    return triangles;
}

} // namespace tristim
