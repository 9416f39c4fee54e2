#include "render/pilot.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace tristim {
namespace {

constexpr int most_tiles_per_side = 24;
constexpr std::size_t samples_per_tile = 3;

float squared_distance(const VisiblePoint& point, const Photon& photon) {
    const float x = photon.x - point.x;
    const float y = photon.y - point.y;
    const float z = photon.z - point.z;
    return x * x + y * y + z * z;
}

/// The distance to the pilot_neighbours-th nearest photon, or to the farthest if there are fewer; infinite if none.
float neighbour_distance(const VisiblePoint& point, const std::vector<Photon>& photons) {
    std::vector<float> nearest; // a heap, the farthest on top
    for (const Photon& photon : photons) {
        const float distance = squared_distance(point, photon);
        if (nearest.size() == pilot_neighbours) {
            if (distance >= nearest.front())
                continue;
            std::pop_heap(nearest.begin(), nearest.end());
            nearest.pop_back();
        }
        nearest.push_back(distance);
        std::push_heap(nearest.begin(), nearest.end());
    }
    return nearest.empty() ? std::numeric_limits<float>::infinity() : std::sqrt(nearest.front());
}

float median(std::vector<float> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// A hundredth of the visible points' extent, for scenes without photons to measure by; 1 if there is no extent either.
float fallback_radius(const std::vector<VisiblePoint>& points) {
    float largest = 0.0F;
    for (const VisiblePoint& point : points) {
        if (point.slot != SLOT_NONE)
            largest = std::max({largest, std::abs(point.x), std::abs(point.y), std::abs(point.z)});
    }
    return largest > 0.0F ? 0.01F * largest : 1.0F;
}

} // namespace

std::vector<float> pilot_radii(const std::vector<VisiblePoint>& points, int width, const std::vector<Photon>& photons) {
    const int height = static_cast<int>(points.size()) / width;
    const int tile = std::max({(width + most_tiles_per_side - 1) / most_tiles_per_side,
                               (height + most_tiles_per_side - 1) / most_tiles_per_side, 1});
    const int tiles_x = (width + tile - 1) / tile;
    const int tiles_y = (height + tile - 1) / tile;
    const auto tile_of = [&](std::size_t pixel) {
        const int index = static_cast<int>(pixel);
        return static_cast<std::size_t>(index / width / tile * tiles_x + index % width / tile);
    };

    // The pixels of a tile are met in scanline order: a golden-ratio stride spreads the few that are measured.
    std::vector<std::vector<float>> distances(static_cast<std::size_t>(tiles_x * tiles_y));
    std::vector<float> all;
    const std::size_t count = points.size();
    std::size_t stride = static_cast<std::size_t>(static_cast<double>(count) * 0.6180339887) | 1U;
    while (std::gcd(stride, count) != 1)
        stride += 2;
    for (std::size_t i = 0, pixel = 0; i < count; ++i, pixel = (pixel + stride) % count) {
        std::vector<float>& measured = distances[tile_of(pixel)];
        if (points[pixel].slot == SLOT_NONE || measured.size() == samples_per_tile)
            continue;
        const float distance = neighbour_distance(points[pixel], photons);
        if (std::isfinite(distance) && distance > 0.0F) {
            measured.push_back(distance);
            all.push_back(distance);
        }
        if (photons.empty())
            break;
    }

    const float typical = all.empty() ? fallback_radius(points) : median(all);
    std::vector<float> radii(points.size());
    std::vector<float> of_tile;
    for (const std::vector<float>& measured : distances)
        of_tile.push_back(measured.empty() ? typical : std::clamp(median(measured), typical / 4.0F, typical * 4.0F));
    for (std::size_t pixel = 0; pixel < radii.size(); ++pixel)
        radii[pixel] = of_tile[tile_of(pixel)];
    return radii;
}

} // namespace tristim
