#pragma once

#include <array>
#include <complex>
#include <numbers>

/// What the optics cases compare the kernels with: textbook formulas in long double.
namespace tristim::selftest::optics {

using Real = long double;
constexpr Real pi = std::numbers::pi_v<Real>;
using Complex = std::complex<Real>;
using Vector = std::array<Real, 3>;

inline Vector operator+(const Vector& a, const Vector& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Vector operator-(const Vector& a, const Vector& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Vector operator*(Real s, const Vector& a) {
    return {s * a[0], s * a[1], s * a[2]};
}
inline Real dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Real length(const Vector& a);
Vector normalized(const Vector& a);
Vector cross(const Vector& a, const Vector& b);

/// The normal component of the wave vector beyond an interface, over that of vacuum on the incident side:
/// q = n cos θ_t = √(n² - sin² θ_i) with n the index beyond over that on the incident side, the root that decays.
Complex normal_component(Real cos_i, Complex n);

/// cos θ_t beyond a dielectric, 0 at total reflection.
Real refraction_cosine(Real cos_i, Real n);

/// Fresnel's reflectance for unpolarised light (Born & Wolf 1999, sections 1.5.2 and 14.2).
Real reflectance(Real cos_i, Complex n);

/// How far a reflectance is from those of indices whose parts are off by up to `units` of float's roundoff 2^-24 each
/// way. Next to a critical angle, where the reflectance's slope is infinite, no float arithmetic can do better than
/// answer such a neighbouring question.
Real reflectance_error(Real value, Real cos_i, Complex n, Real units);

/// Shares of power that a layer of index `film` and thickness/λ `thickness` on an interface to n reflects and
/// transmits, unpolarised: Airy's sum of all orders (Born & Wolf 1999, section 7.6). q of the film must not be 0.
struct Shares {
    Real reflected, transmitted;
};
Shares film_shares(Real cos_i, Complex film, Real thickness, Complex n);

/// GGX with Smith's masking as functions of slopes and tangents (Walter et al. 2007; Heitz 2014), in the frame of
/// kernels/microfacet.h.
struct Ggx {
    Real u, v; ///< α

    Real distribution(const Vector& m) const;
    Real masking(const Vector& w) const;
    Real masking_shadowing(const Vector& wo, const Vector& wi) const;
    /// The weight of a direction that was sampled by a visible normal: masking_shadowing(wo, wi) / masking(wo).
    Real weight(const Vector& wo, const Vector& wi) const;
    /// [1/sr] of facets that wo sees.
    Real visible_pdf(const Vector& wo, const Vector& m) const;
    /// [1/sr] of the directions that they reflect wo to; m is the facet.
    Real reflection_pdf(const Vector& wo, const Vector& m) const;
    Real reflection(const Vector& wo, const Vector& wi) const;
    /// [1/sr] of the directions that facets refract wo to, by Snell's law at the facet m, eta = n_i/n_o.
    Real refraction_pdf(const Vector& wo, const Vector& m, Real eta) const;
};

} // namespace tristim::selftest::optics
