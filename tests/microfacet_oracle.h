#pragma once

// The GGX microfacet distribution in double, and what integrates it.

#include "kernel_harness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace tristim::kernel_test {

inline cl_float4 float4_of(const Vec3& v, double w = 0.0) {
    return {{static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]), static_cast<float>(w)}};
}
inline Vec3 at_angle(double degrees, double turns) {
    const double theta = degrees * std::numbers::pi / 180.0, phi = 2.0 * std::numbers::pi * turns;
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}
/// Σ |a_k b_k|: the rounding of a product of components that are off by u each is u times this.
inline double absolute_dot(const Vec3& a, const Vec3& b) {
    return std::abs(a[0] * b[0]) + std::abs(a[1] * b[1]) + std::abs(a[2] * b[2]);
}

/// The textbook formulas (Walter et al. 2007; Heitz 2014), as functions of tan θ.
struct Ggx {
    double u, v;
    explicit Ggx(const cl_float2& alpha) : u(alpha.s[0]), v(alpha.s[1]) {}

    double distribution(const Vec3& m) const {
        const double cos2 = m[2] * m[2];
        const double tan2_over_alpha2 = (m[0] * m[0] / (u * u) + m[1] * m[1] / (v * v)) / cos2;
        return 1.0 / (std::numbers::pi * u * v * cos2 * cos2 * std::pow(1.0 + tan2_over_alpha2, 2));
    }
    double lambda(const Vec3& w) const {
        const double alpha2_tan2 = (u * u * w[0] * w[0] + v * v * w[1] * w[1]) / (w[2] * w[2]);
        return 0.5 * alpha2_tan2 / (1.0 + std::sqrt(1.0 + alpha2_tan2));
    }
    double masking(const Vec3& w) const { return 1.0 / (1.0 + lambda(w)); }
    double masking_shadowing(const Vec3& wo, const Vec3& wi) const { return 1.0 / (1.0 + lambda(wo) + lambda(wi)); }
    double visible_pdf(const Vec3& wo, const Vec3& m) const {
        return masking(wo) * std::max(0.0, dot(wo, m)) * distribution(m) / wo[2];
    }

    static Vec3 reflecting(const Vec3& wo, const Vec3& wi) { return normalized(wo + wi); }
    double reflection(const Vec3& wo, const Vec3& wi) const {
        return distribution(reflecting(wo, wi)) * masking_shadowing(wo, wi) / (4.0 * wo[2] * wi[2]);
    }
    double reflection_pdf(const Vec3& wo, const Vec3& wi) const {
        const Vec3 m = reflecting(wo, wi);
        return visible_pdf(wo, m) / (4.0 * dot(wo, m));
    }

    static Vec3 refracting(const Vec3& wo, const Vec3& wi, double eta) {
        const Vec3 m = normalized(wo + eta * wi);
        return m[2] < 0.0 ? -1.0 * m : m;
    }
    static double jacobian(const Vec3& wo, const Vec3& wi, const Vec3& m, double eta) {
        return std::abs(dot(wi, m)) / std::pow(dot(wi, m) + dot(wo, m) / eta, 2);
    }
    static bool refracts(const Vec3& wo, const Vec3& wi, const Vec3& m) { return dot(wo, m) > 0.0 && dot(wi, m) < 0.0; }
    double refraction(const Vec3& wo, const Vec3& wi, double eta) const {
        const Vec3 m = refracting(wo, wi, eta);
        return !refracts(wo, wi, m) ? 0.0
                                    : distribution(m) * masking_shadowing(wo, wi) * dot(wo, m) *
                                          jacobian(wo, wi, m, eta) / std::abs(wo[2] * wi[2]);
    }
    double refraction_pdf(const Vec3& wo, const Vec3& wi, double eta) const {
        const Vec3 m = refracting(wo, wi, eta);
        return refracts(wo, wi, m) ? visible_pdf(wo, m) * jacobian(wo, wi, m, eta) : 0.0;
    }
};

/// Stretching by (1/α_u, 1/α_v, 1) turns the GGX surface into a hemisphere, of which wo sees a lune: the points p above
/// the horizon and on the side of the stretched wo. (a, β) are angles on it, a along the great circle through the
/// normal and wo, β away from that.
class Lune {
  public:
    Lune(const Vec3& wo, const cl_float2& alpha) : u_(alpha.s[0]), v_(alpha.s[1]) {
        const Vec3 stretched{u_ * wo[0], v_ * wo[1], wo[2]};
        const double across = std::hypot(stretched[0], stretched[1]);
        along_ = across > 0.0 ? Vec3{stretched[0] / across, stretched[1] / across, 0.0} : Vec3{1.0, 0.0, 0.0};
        side_ = {-along_[1], along_[0], 0.0};
        theta_ = std::atan2(across, stretched[2]);
    }
    /// From (s, t) in the unit square: the facet and the solid angle that it stands for, per unit of the square.
    std::pair<Vec3, double> facet(double s, double t) const {
        const double a = theta_ - std::numbers::pi / 2.0 + s * (std::numbers::pi - theta_),
                     beta = std::numbers::pi * (t - 0.5);
        const Vec3 p =
            std::cos(beta) * (std::sin(a) * along_ + std::cos(a) * Vec3{0.0, 0.0, 1.0}) + std::sin(beta) * side_;
        const Vec3 m{u_ * p[0], v_ * p[1], p[2]};
        return {normalized(m),
                (std::numbers::pi - theta_) * std::numbers::pi * std::cos(beta) * u_ * v_ / std::pow(length(m), 3)};
    }
    std::array<double, 2> square(const Vec3& m) const {
        const Vec3 p = normalized({m[0] / u_, m[1] / v_, m[2]});
        const double a = std::atan2(dot(p, along_), p[2]);
        return {(a - theta_ + std::numbers::pi / 2.0) / (std::numbers::pi - theta_),
                std::asin(std::clamp(dot(p, side_), -1.0, 1.0)) / std::numbers::pi + 0.5};
    }

  private:
    double u_, v_, theta_;
    Vec3 along_, side_;
};

struct Node {
    double x, weight;
};
/// Gauss and Legendre's rule on [0, 1], by Newton's method from Abramowitz & Stegun 1964, 22.16.6.
inline std::vector<Node> gauss_legendre(int n) {
    std::vector<Node> nodes;
    for (int i = 0; i < n; ++i) {
        double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5)), slope = 0.0;
        for (int iteration = 0; iteration < 20; ++iteration) {
            double previous = 1.0, value = x;
            for (int k = 2; k <= n; ++k)
                previous = std::exchange(value, ((2 * k - 1) * x * value - (k - 1) * previous) / k);
            slope = n * (x * value - previous) / (x * x - 1.0);
            x -= value / slope;
        }
        nodes.push_back({0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope)});
    }
    return nodes;
}

struct Rectangle {
    double x0, x1, y0, y1;
};
using Function = std::function<double(double, double)>;

inline double integral(const std::vector<Node>& rule, const Rectangle& r, const Function& f) {
    double sum = 0.0;
    for (const Node& x : rule) {
        for (const Node& y : rule)
            sum += x.weight * y.weight * f(r.x0 + x.x * (r.x1 - r.x0), r.y0 + y.x * (r.y1 - r.y0));
    }
    return sum * (r.x1 - r.x0) * (r.y1 - r.y0);
}

/// Quarters a rectangle, twice at least so that no lobe is overlooked, until that changes the integral over a piece
/// by less than 1e-7. Lobes near the horizon are narrow, and borders of total reflection cut through.
inline double adaptive_integral(const Rectangle& r, const Function& f, int depth = 0) {
    static const std::vector<Node> rule = gauss_legendre(4);
    const double x = 0.5 * (r.x0 + r.x1), y = 0.5 * (r.y0 + r.y1);
    const std::array<Rectangle, 4> quarters{
        {{r.x0, x, r.y0, y}, {x, r.x1, r.y0, y}, {r.x0, x, y, r.y1}, {x, r.x1, y, r.y1}}};
    double sum = 0.0;
    if (depth >= 2) {
        for (const Rectangle& quarter : quarters)
            sum += integral(rule, quarter, f);
        if (std::abs(sum - integral(rule, r, f)) < 1e-7 || depth == 20)
            return sum;
        sum = 0.0;
    }
    for (const Rectangle& quarter : quarters)
        sum += adaptive_integral(quarter, f, depth + 1);
    return sum;
}

inline const std::vector<cl_float2> alphas{{{1e-4F, 1e-4F}}, {{1e-3F, 1e-3F}}, {{0.05F, 0.05F}}, {{0.3F, 0.3F}},
                                           {{1.0F, 1.0F}},   {{0.1F, 0.6F}},   {{0.5F, 0.001F}}};
inline std::string name(const cl_float2& alpha, double degrees) {
    return fmt::format("alpha = ({}, {}), {}°", alpha.s[0], alpha.s[1], degrees);
}

// Error bounds, in units of float's roundoff u; OpenCL's division is right to 5 u, its square root to 6 u. A facet's
// slopes: 6 u for 1/(α_u α_v), 2 u for products; squared and summed 19 u, squared again 39 u; 8 u for the numerator and
// 5 u for the division. Stretched lengths: 5 u under the root, so 8.5 u.
inline constexpr double distribution_units = 52.0;
inline constexpr double length_units = 8.5;
// A half vector: 1 u for the sum, whose squared length then has 5 u and whose inverse length 13.5 u; 1 u for the
// product. It enters D to the fourth power.
inline constexpr double half_vector_units = 15.5;
inline constexpr double half_distribution_units = distribution_units + 4.0 * half_vector_units;

// A weight: two sums of lengths (2 u for product and sum) and a division.
inline constexpr double weight_units = 2.0 * (length_units + 2.0) + 5.0;

} // namespace tristim::kernel_test
