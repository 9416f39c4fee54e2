#include "meshes/mesh_checks.h"

#include "base/error.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>

namespace tristim {

namespace {

/// One side of a face, keyed by its two vertices in ascending order.
struct Side {
    int low;
    int high;
    bool ascending; ///< the face runs from low to high
    std::size_t face;
    std::size_t corner; ///< number of the corner where the side starts, among the corners of all faces
    std::size_t next;   ///< number of the corner where it ends
};

/// Sets of corners that share a vertex and are joined by edges.
class CornerSets {
  public:
    explicit CornerSets(std::size_t count) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), std::size_t{0});
    }

    std::size_t find(std::size_t corner) {
        while (parent_[corner] != corner)
            corner = parent_[corner] = parent_[parent_[corner]];
        return corner;
    }

    void join(std::size_t a, std::size_t b) { parent_[find(a)] = find(b); }

  private:
    std::vector<std::size_t> parent_;
};

std::vector<Side> sorted_sides(const Faces& faces) {
    std::vector<Side> sides;
    std::size_t corner = 0;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        const std::size_t n = faces[f].size();
        for (std::size_t i = 0; i < n; ++i) {
            const int a = faces[f][i];
            const int b = faces[f][(i + 1) % n];
            sides.push_back({std::min(a, b), std::max(a, b), a < b, f, corner + i, corner + (i + 1) % n});
        }
        corner += n;
    }
    std::sort(sides.begin(), sides.end(), [](const Side& s, const Side& t) {
        return std::array{s.low, s.high} < std::array{t.low, t.high} ||
               (std::array{s.low, s.high} == std::array{t.low, t.high} && s.face < t.face);
    });
    return sides;
}

} // namespace

void check_manifold(const std::string& path, const Faces& faces, std::size_t vertices, int first_index) {
    const std::vector<Side> sides = sorted_sides(faces);
    CornerSets fans(sides.size());
    for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
        const Side& side = sides[begin];
        while (end < sides.size() && sides[end].low == side.low && sides[end].high == side.high)
            ++end;
        if (end - begin > 2)
            fail("{}: the mesh is not a manifold: {} faces share the edge between the vertices {} and {}", path,
                 end - begin, side.low + first_index, side.high + first_index);
        if (end - begin == 2) {
            const Side& other = sides[begin + 1];
            if (side.ascending == other.ascending)
                fail("{}: the mesh is not an oriented manifold: two faces run through the edge between the vertices {} "
                     "and {} in the same direction",
                     path, side.low + first_index, side.high + first_index);
            fans.join(side.corner, other.next);
            fans.join(side.next, other.corner);
        }
    }
    std::vector<std::size_t> fan_of(vertices, sides.size());
    std::size_t corner = 0;
    for (const std::vector<int>& face : faces) {
        for (const int vertex : face) {
            std::size_t& fan = fan_of[static_cast<std::size_t>(vertex)];
            const std::size_t mine = fans.find(corner++);
            if (fan == sides.size())
                fan = mine;
            else if (fan != mine)
                fail("{}: the mesh is not a manifold: the faces at the vertex {} form several separate fans", path,
                     vertex + first_index);
        }
    }
}

} // namespace tristim
