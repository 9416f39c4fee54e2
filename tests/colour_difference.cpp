#include "colour_difference.h"

#include <cmath>
#include <numbers>

namespace tristim::test {

namespace {

constexpr double degrees = std::numbers::pi / 180.0;

/// x⁷ / (x⁷ + 25⁷), which equations 4 and 18 take the root of.
double seventh_power_share(double x) {
    return std::pow(x, 7.0) / (std::pow(x, 7.0) + std::pow(25.0, 7.0));
}

/// The hue angle in degrees, in [0, 360); 0 for greys (equation 7).
double hue(double a, double b) {
    if (a == 0.0 && b == 0.0)
        return 0.0;
    const double angle = std::atan2(b, a) / degrees;
    return angle < 0.0 ? angle + 360.0 : angle;
}

} // namespace

Lab to_lab(const Xyz& xyz, const Xyz& white) {
    std::array<double, 3> f{};
    for (std::size_t i = 0; i < 3; ++i) {
        const double ratio = xyz[i] / white[i];
        f[i] = ratio > std::pow(6.0 / 29.0, 3) ? std::cbrt(ratio) : ratio * (841.0 / 108.0) + 4.0 / 29.0;
    }
    return {116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])};
}

double delta_e_1976(const Lab& a, const Lab& b) {
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

double delta_e_2000(const Lab& first, const Lab& second) {
    // Equations 2 to 7: chroma and hue with a* stretched near grey.
    const double mean_c_ab = 0.5 * (std::hypot(first[1], first[2]) + std::hypot(second[1], second[2]));
    const double g = 0.5 * (1.0 - std::sqrt(seventh_power_share(mean_c_ab)));
    const double a1 = (1.0 + g) * first[1];
    const double a2 = (1.0 + g) * second[1];
    const double c1 = std::hypot(a1, first[2]);
    const double c2 = std::hypot(a2, second[2]);
    const double h1 = hue(a1, first[2]);
    const double h2 = hue(a2, second[2]);
    // Equations 8 to 11: differences.
    const bool grey = c1 * c2 == 0.0;
    double dh = grey ? 0.0 : h2 - h1;
    if (dh > 180.0)
        dh -= 360.0;
    else if (dh < -180.0)
        dh += 360.0;
    const double delta_l = second[0] - first[0];
    const double delta_c = c2 - c1;
    const double delta_h = 2.0 * std::sqrt(c1 * c2) * std::sin(0.5 * dh * degrees);
    // Equations 12 to 14: means.
    const double mean_l = 0.5 * (first[0] + second[0]);
    const double mean_c = 0.5 * (c1 + c2);
    double mean_h = h1 + h2;
    if (!grey) {
        if (std::abs(h1 - h2) > 180.0)
            mean_h += h1 + h2 < 360.0 ? 360.0 : -360.0;
        mean_h *= 0.5;
    }
    // Equations 15 to 22: weights.
    const double t = 1.0 - 0.17 * std::cos((mean_h - 30.0) * degrees) + 0.24 * std::cos(2.0 * mean_h * degrees) +
                     0.32 * std::cos((3.0 * mean_h + 6.0) * degrees) - 0.20 * std::cos((4.0 * mean_h - 63.0) * degrees);
    const double delta_theta = 30.0 * std::exp(-std::pow((mean_h - 275.0) / 25.0, 2.0));
    const double r_c = 2.0 * std::sqrt(seventh_power_share(mean_c));
    const double from_fifty = (mean_l - 50.0) * (mean_l - 50.0);
    const double s_l = 1.0 + 0.015 * from_fifty / std::sqrt(20.0 + from_fifty);
    const double s_c = 1.0 + 0.045 * mean_c;
    const double s_h = 1.0 + 0.015 * mean_c * t;
    const double r_t = -std::sin(2.0 * delta_theta * degrees) * r_c;
    const double l = delta_l / s_l;
    const double c = delta_c / s_c;
    const double h = delta_h / s_h;
    return std::sqrt(l * l + c * c + h * h + r_t * c * h);
}

} // namespace tristim::test
