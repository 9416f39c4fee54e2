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
    // Cutting off an ear of a simple polygon makes or unmakes ears of its two neighbours alone (Meisters 1975), so that
    // the other corners need no second look until no ear is known. That happens where corners are collinear or edges
    // cross; the time that is spent on looking then has a limit.
    constexpr std::size_t most_tests = 100'000'000;
    std::size_t looks_left = most_tests / (corners.size() * corners.size());
    std::vector<bool> is_known_ear(corners.size());
    const auto look_at_all = [&] {
        for (std::size_t at = 0; at < ring.size(); ++at)
            is_known_ear[ring[at]] = is_ear(corners, ring, at, normal);
    };
    const auto find_ear = [&] {
        return static_cast<std::size_t>(
            std::find_if(ring.begin(), ring.end(), [&](std::size_t corner) { return is_known_ear[corner]; }) -
            ring.begin());
    };
    if (ring.size() > 3)
        look_at_all();
    while (ring.size() > 3) {
        std::size_t ear = find_ear();
        if (ear == ring.size() && looks_left > 0) {
            look_at_all();
            --looks_left;
            ear = find_ear();
        }
        // Collinear or self-intersecting corners leave no ear: cut off any one.
        if (ear == ring.size())
            ear = 1;
        const std::size_t n = ring.size();
        triangles.push_back({ring[(ear + n - 1) % n], ring[ear], ring[(ear + 1) % n]});
        ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(ear));
        for (const std::size_t at : {(ear + n - 2) % (n - 1), ear % (n - 1)})
            is_known_ear[ring[at]] = is_ear(corners, ring, at, normal);
    }
    triangles.push_back({ring[0], ring[1], ring[2]});
    return triangles;
}

} // namespace tristim
