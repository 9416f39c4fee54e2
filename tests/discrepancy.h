#pragma once

#include <algorithm>
#include <vector>

namespace tristim::test {

/// The star discrepancy of points in [0, 1), at least one: how far their share below any x is from x at most.
inline double star_discrepancy(std::vector<double> points) {
    std::sort(points.begin(), points.end());
    const auto n = static_cast<double>(points.size());
    double largest = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto below = static_cast<double>(i);
        largest = std::max({largest, points[i] - below / n, (below + 1.0) / n - points[i]});
    }
    return largest;
}

} // namespace tristim::test
