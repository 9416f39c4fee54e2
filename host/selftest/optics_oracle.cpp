#include "selftest/optics_oracle.h"

#include <algorithm>
#include <cmath>

namespace tristim::selftest::optics {
namespace {

/// α² tan² θ.
Real stretched_tangent2(const Ggx& ggx, const Vector& w) {
    return (ggx.u * ggx.u * w[0] * w[0] + ggx.v * ggx.v * w[1] * w[1]) / (w[2] * w[2]);
}

/// Smith's Λ.
Real lambda(const Ggx& ggx, const Vector& w) {
    const Real t = stretched_tangent2(ggx, w);
    return 0.5L * t / (1.0L + std::sqrt(1.0L + t));
}

} // namespace

Real length(const Vector& a) {
    return std::sqrt(dot(a, a));
}

Vector normalized(const Vector& a) {
    return (1.0L / length(a)) * a;
}

Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Complex normal_component(Real cos_i, Complex n) {
    // n² - 1 + cos² keeps its digits where n is nearly 1 and the light grazes.
    const Complex q = std::sqrt((n - 1.0L) * (n + 1.0L) + cos_i * cos_i);
    return q.imag() < 0.0L ? -q : q;
}

Real refraction_cosine(Real cos_i, Real n) {
    return normal_component(cos_i, n).real() / n;
}

Real reflectance(Real cos_i, Complex n) {
    if (cos_i == 0.0L)
        return 1.0L;
    const Complex q = normal_component(cos_i, n), n2 = n * n;
    return 0.5L * (std::norm((cos_i - q) / (cos_i + q)) + std::norm((n2 * cos_i - q) / (n2 * cos_i + q)));
}

Real reflectance_error(Real value, Real cos_i, Complex n, Real units) {
    const Real exact = reflectance(cos_i, n), unit = units * 0x1p-24L;
    Real low = exact, high = exact;
    for (const Real re : {-unit, 0.0L, unit}) {
        for (const Real im : {-unit, unit}) {
            const Real moved = reflectance(cos_i, {n.real() * (1.0L + re), n.imag() * (1.0L + im)});
            low = std::min(low, moved);
            high = std::max(high, moved);
        }
    }
    return value < low ? low - value : value > high ? value - high : value >= low ? 0.0L : value; // NaN stays
}

Shares film_shares(Real cos_i, Complex film, Real thickness, Complex n) {
    const Complex above = cos_i, within = normal_component(cos_i, film), below = normal_component(cos_i, n);
    const Complex turn = std::exp(Complex(0.0L, 2.0L * pi * thickness) * within);
    Shares shares{0.0L, 0.0L};
    for (const bool p : {false, true}) {
        const auto admittance = [p](Complex q, Complex index) { return p ? index * index / q : q; };
        const Complex a = admittance(above, 1.0L), f = admittance(within, film), b = admittance(below, n);
        const Complex r1 = (a - f) / (a + f), r2 = (f - b) / (f + b);
        const Complex all = 1.0L + r1 * r2 * turn * turn;
        const Complex t = 2.0L * a / (a + f) * 2.0L * f / (f + b) * turn / all;
        shares.reflected += 0.5L * std::norm((r1 + r2 * turn * turn) / all);
        shares.transmitted += 0.5L * std::norm(t) * b.real() / a.real();
    }
    return shares;
}

Real Ggx::distribution(const Vector& m) const {
    const Real x = m[0] / m[2] / u, y = m[1] / m[2] / v;
    const Real of_slopes = 1.0L / (pi * u * v * std::pow(1.0L + x * x + y * y, 2.0L));
    return of_slopes / std::pow(m[2], 4.0L);
}

Real Ggx::masking(const Vector& w) const {
    return 1.0L / (1.0L + lambda(*this, w));
}

Real Ggx::masking_shadowing(const Vector& wo, const Vector& wi) const {
    return 1.0L / (1.0L + lambda(*this, wo) + lambda(*this, wi));
}

Real Ggx::weight(const Vector& wo, const Vector& wi) const {
    return (1.0L + lambda(*this, wo)) / (1.0L + lambda(*this, wo) + lambda(*this, wi));
}

Real Ggx::visible_pdf(const Vector& wo, const Vector& m) const {
    return masking(wo) * std::max(0.0L, dot(wo, m)) * distribution(m) / wo[2];
}

Real Ggx::reflection_pdf(const Vector& wo, const Vector& m) const {
    return masking(wo) * distribution(m) / (4.0L * wo[2]);
}

Real Ggx::reflection(const Vector& wo, const Vector& wi) const {
    return distribution(normalized(wo + wi)) * masking_shadowing(wo, wi) / (4.0L * wo[2] * wi[2]);
}

Real Ggx::refraction_pdf(const Vector& wo, const Vector& m, Real eta) const {
    const Real o = std::max(0.0L, dot(wo, m)), i = refraction_cosine(o, eta);
    // wo + eta wi is so much along m that its length is eta cos θ_t - cos θ_o, of which the squares differ by eta² - 1.
    const Real along = (eta - 1.0L) * (eta + 1.0L) / (eta * i + o);
    return visible_pdf(wo, m) * eta * eta * i / (along * along);
}

} // namespace tristim::selftest::optics
