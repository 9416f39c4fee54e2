#include "render/error_trend.h"

#include <cmath>

namespace tristim {

std::optional<double> ErrorTrend::passes_to(double target) const {
    constexpr std::uint64_t reach = 8;
    constexpr double fewest_points = 3.0;
    double count = 0.0, mean_x = 0.0, mean_y = 0.0, xx = 0.0, xy = 0.0;
    for (const Point& point : points_) {
        if (point.passes * reach < points_.back().passes || !(point.rmse > 0.0))
            continue;
        const double x = std::log(static_cast<double>(point.passes)), y = std::log(point.rmse);
        ++count;
        // Welford's updates of the sums about the means.
        const double dx = x - mean_x;
        mean_x += dx / count;
        mean_y += (y - mean_y) / count;
        xx += dx * (x - mean_x);
        xy += dx * (y - mean_y);
    }
    if (count < fewest_points || !(xy < 0.0))
        return {};
    return std::exp(mean_x + (std::log(target) - mean_y) * xx / xy);
}

} // namespace tristim
