// The tangential fields u, v of a plane wave in a layer follow from Maxwell's equations (Berreman 1972, J. Opt. Soc.
// Am. 62, 502, whose four equations separate in isotropic media). With z downwards, β = n0 sin θ, ε = (n + ik)², k0 =
// 2π/λ and H in units of E/Z0:
//
//   s: u = E_y, v = -H_x    du/dz = i k0 v               p: u = E_x, v = H_y    du/dz = i k0 (1 - β²/ε) v
//                           dv/dz = i k0 (ε - β²) u                             dv/dz = i k0 ε u
//
// Power along z is Re(u v*)/2 for both. A layer carries (u, v) from its lower to its upper face by the exponential of a
// 2×2 matrix without diagonal, taken from its power series and repeated squaring. The wave that leaves downwards, (1,
// q) or (q, ε) with q = √(ε - β²), starts at the base; going up, evanescent waves only grow, so nothing cancels, and
// powers of two split off keep the numbers in range.
#include "selftest/film_oracle.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <ranges>

namespace tristim::oracle {
namespace {

using Real = long double;
using Complex = std::complex<Real>;

// Without the care for infinities that costs std::complex most of its time.
Complex times(const Complex& a, const Complex& b) {
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

Real largest(std::initializer_list<Complex> values) {
    Real result = 0.0L;
    for (const Complex& value : values)
        result = std::max({result, std::abs(value.real()), std::abs(value.imag())});
    return result;
}

/// exp(M) = 2^exponent (even + odd M) for a matrix M = (0, b; c, 0), whose square is bc.
struct Exponential {
    Complex even = 1.0L, odd = 1.0L;
    long exponent = 0;
};

Exponential exponential(Complex bc) {
    constexpr int terms = 9; // (1/16)^9/18! < 1e-26
    int doublings = 0;
    for (Real size = largest({bc}); size > 0.0625L; size *= 0.25L)
        ++doublings;
    bc *= std::ldexp(1.0L, -2 * doublings);
    Exponential e;
    Complex term = 1.0L;
    for (int i = 1; i <= terms; ++i) {
        term = times(term, bc) / static_cast<Real>((2 * i - 1) * (2 * i));
        e.even += term;
        e.odd += term / static_cast<Real>(2 * i + 1);
    }
    // (even + odd M)² = even² + bc odd² + even odd (2M)
    for (int i = 0; i < doublings; ++i) {
        const Complex odd = times(e.even, e.odd);
        e.even = times(e.even, e.even) + times(bc, times(e.odd, e.odd));
        e.odd = odd;
        bc *= 4.0L;
        const int shift = std::ilogb(largest({e.even, e.odd}));
        const Real scale = std::ldexp(1.0L, -shift);
        e.even *= scale, e.odd *= scale;
        e.exponent = 2 * e.exponent + shift;
    }
    return e;
}

/// 2^exponent (u, v)
struct Fields {
    Complex u, v;
    long exponent = 0;
};

/// exp(0, b; c, 0) (u, v)
Fields carry(const Exponential& e, const Complex& b, const Complex& c, const Fields& f) {
    Fields r{times(e.even, f.u) + times(e.odd, times(b, f.v)), times(e.even, f.v) + times(e.odd, times(c, f.u)),
             e.exponent + f.exponent};
    const int shift = std::ilogb(largest({r.u, r.v}));
    const Real scale = std::ldexp(1.0L, -shift);
    r.u *= scale, r.v *= scale;
    r.exponent += shift;
    return r;
}

struct Medium {
    Complex epsilon;
    Complex q2; ///< ε - β²
};

struct LayerOfFilm {
    Medium medium;
    Real k0_thickness;
    Exponential exponential; ///< of both polarisations: bc = -k0² d² q² either way
};

struct Share {
    double reflected, transmitted;
};

/// `first` is where the light comes from, at a cosine times index of q0 > 0.
Share share(const Medium& first, Real q0, const std::vector<LayerOfFilm>& layers, const Medium& last,
            bool s_polarised) {
    Complex q = std::sqrt(last.q2);
    if (q.imag() < 0.0L || (q.imag() == 0.0L && q.real() < 0.0L))
        q = -q;
    const Fields base = s_polarised ? Fields{1.0L, q} : Fields{q, last.epsilon};
    Fields top = base;
    for (const LayerOfFilm& layer : layers | std::views::reverse) {
        const Complex up = Complex(0.0L, -layer.k0_thickness);
        const Medium& m = layer.medium;
        top = s_polarised ? carry(layer.exponential, up, times(up, m.q2), top)
                          : carry(layer.exponential, times(up, m.q2) / m.epsilon, times(up, m.epsilon), top);
    }
    // Waves down and up at the top: u = a + b, v = Y (a - b) with Y = q0 or ε/q0.
    const Complex x = s_polarised ? q0 * top.u : first.epsilon * top.u;
    const Complex y = s_polarised ? top.v : q0 * top.v;
    const Real incident = std::norm(x + y);
    const Real base_power = (base.u * std::conj(base.v)).real();
    const Real weight = 4.0L * q0 * (s_polarised ? 1.0L : first.epsilon.real());
    const long exponent = std::max(-2 * top.exponent, -100000L); // 0 long before
    return {static_cast<double>(std::norm(x - y) / incident),
            static_cast<double>(std::ldexp(weight * base_power / incident, static_cast<int>(exponent)))};
}

} // namespace

FilmOptics film(double n0, const std::vector<Layer>& layers, double base_n, double base_k, double lambda, double cos_i,
                bool from_outside) {
    // At the limit of grazing incidence nothing here cancels, so a tiny cosine is as good as none.
    const Real q0 = static_cast<Real>(from_outside ? n0 : base_n) * std::max(static_cast<Real>(cos_i), 1e-15L);
    const Complex outside(n0), base(base_n, base_k);
    const Complex first_epsilon = from_outside ? outside * outside : base * base;
    const auto medium = [&](const Complex& index) {
        // ε - β² with β² = ε_first - q0²: what two equal media differ by is then exactly nothing.
        const Complex epsilon = index * index;
        return Medium{epsilon, (epsilon - first_epsilon) + q0 * q0};
    };
    std::vector<LayerOfFilm> between;
    for (const Layer& layer : layers) {
        const Medium m = medium(Complex(layer.n, layer.k));
        const Real k0_thickness =
            2.0L * std::numbers::pi_v<Real> / static_cast<Real>(lambda) * static_cast<Real>(layer.thickness);
        between.push_back({m, k0_thickness, exponential(-k0_thickness * k0_thickness * m.q2)});
    }
    if (!from_outside)
        std::ranges::reverse(between);
    const Medium first = medium(from_outside ? outside : base), last = medium(from_outside ? base : outside);
    const Share s = share(first, q0, between, last, true);
    const Share p = share(first, q0, between, last, false);
    return {s.reflected, p.reflected, s.transmitted, p.transmitted};
}

} // namespace tristim::oracle
