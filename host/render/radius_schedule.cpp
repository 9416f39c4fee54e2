#include "render/radius_schedule.h"

#include <algorithm>
#include <cmath>

namespace tristim {

double radius_scale(std::uint32_t pass, double alpha) {
    const double i = static_cast<double>(pass) + 1.0;
    // log Γ loses what the difference of two large ones needs, 1e-5 at the last pass. Γ(i+α)/Γ(i+1) is w^(α-1) with
    // w = i + α/2, but for a term in w^-2 and one below 1e-16 here (Tricomi & Erdélyi 1951; DLMF 5.11.14).
    constexpr double from_here_on = 10000.0;
    if (i >= from_here_on) {
        const double w = i + 0.5 * alpha;
        const double ratio = std::pow(w, alpha - 1.0) * (1.0 + (1.0 - alpha) * alpha * (alpha - 2.0) / (24.0 * w * w));
        return std::sqrt(ratio / std::tgamma(1.0 + alpha));
    }
    return std::exp(0.5 * (std::lgamma(i + alpha) - std::lgamma(1.0 + alpha) - std::lgamma(i + 1.0)));
}

float largest_radius_floor(const SceneConstants& c) {
    const float centre = std::max({std::abs(c.centre_x), std::abs(c.centre_y), std::abs(c.centre_z)});
    return std::max(SMALLEST_RELATIVE_RADIUS * (centre + c.radius), SMALLEST_RADIUS);
}

} // namespace tristim
