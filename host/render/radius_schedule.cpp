#include "render/radius_schedule.h"

#include <cmath>

namespace tristim {

double radius_scale(std::uint32_t pass, double alpha) {
    const double i = static_cast<double>(pass) + 1.0;
    return std::exp(0.5 * (std::lgamma(i + alpha) - std::lgamma(1.0 + alpha) - std::lgamma(i + 1.0)));
}

} // namespace tristim
