// The tangential fields u, v of a plane wave in a layer follow from Maxwell's equations (Berreman 1972, J. Opt. Soc.
// Am. 62, 502, whose four equations separate in isotropic media). With z downwards, β = n0 sin θ, ε = (n + ik)², k0 =
// 2π/λ and H in units of E/Z0:
//
//   s: u = E_y, v = -H_x    du/dz = i k0 v               p: u = E_x, v = H_y    du/dz = i k0 (1 - β²/ε) v
//                           dv/dz = i k0 (ε - β²) u                             dv/dz = i k0 ε u
//
// Power along z is Re(u v*)/2 for both. A layer carries (u, v) from its lower to its upper face by the exponential of a
// 2×2 matrix, taken from its power series and repeated squaring. The wave that leaves downwards, (1, q) or (q, ε) with
// q = √(ε - β²), starts at the base; going up, evanescent waves only grow, so nothing cancels, and powers of two split
// off keep the numbers in range.
#include "thin_film_oracle.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <ranges>

namespace tristim::oracle {
namespace {

using Real = long double;
using Complex = std::complex<Real>;

/// 2^exponent (a, b; c, d)
struct Matrix {
    Complex a, b, c, d;
    long exponent = 0;
};

Real largest(std::initializer_list<Complex> values) {
    Real result = 0.0L;
    for (const Complex& value : values)
        result = std::max({result, std::abs(value.real()), std::abs(value.imag())});
    return result;
}

Matrix square(const Matrix& m) {
    Matrix r{m.a * m.a + m.b * m.c, m.b * (m.a + m.d), m.c * (m.a + m.d), m.d * m.d + m.b * m.c, 2 * m.exponent};
    const int shift = std::ilogb(largest({r.a, r.b, r.c, r.d}));
    const Real scale = std::ldexp(1.0L, -shift);
    r.a *= scale, r.b *= scale, r.c *= scale, r.d *= scale;
    r.exponent += shift;
    return r;
}

/// exp(0, b; c, 0)
Matrix exponential(Complex b, Complex c) {
    constexpr int terms = 24; // 0.5^24/24! < 1e-30
    int squarings = 0;
    for (Real size = largest({b, c}); size > 0.25L; size *= 0.5L)
        ++squarings;
    const Real scale = std::ldexp(1.0L, -squarings);
    b *= scale, c *= scale;
    Matrix sum{1.0L, 0.0L, 0.0L, 1.0L};
    Matrix term = sum;
    for (int i = 1; i <= terms; ++i) {
        const Real inverse = 1.0L / static_cast<Real>(i);
        term = {term.b * c * inverse, term.a * b * inverse, term.d * c * inverse, term.c * b * inverse};
        sum.a += term.a, sum.b += term.b, sum.c += term.c, sum.d += term.d;
    }
    for (int i = 0; i < squarings; ++i)
        sum = square(sum);
    return sum;
}

/// 2^exponent (u, v)
struct Fields {
    Complex u, v;
    long exponent = 0;
};

Fields operator*(const Matrix& m, const Fields& f) {
    Fields r{m.a * f.u + m.b * f.v, m.c * f.u + m.d * f.v, m.exponent + f.exponent};
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

struct Share {
    double reflected, transmitted;
};

/// `first` is where the light comes from, at a cosine times index of q0 > 0.
Share share(const Medium& first, Real q0, const std::vector<Medium>& media, const std::vector<Real>& k0_thickness,
            const Medium& last, bool s_polarised) {
    Complex q = std::sqrt(last.q2);
    if (q.imag() < 0.0L || (q.imag() == 0.0L && q.real() < 0.0L))
        q = -q;
    const Fields base = s_polarised ? Fields{1.0L, q} : Fields{q, last.epsilon};
    Fields top = base;
    for (std::size_t i = media.size(); i-- > 0;) {
        const Complex up = Complex(0.0L, -1.0L) * k0_thickness[i];
        const Matrix layer = s_polarised ? exponential(up, up * media[i].q2)
                                         : exponential(up * media[i].q2 / media[i].epsilon, up * media[i].epsilon);
        top = layer * top;
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
    std::vector<Medium> media;
    std::vector<Real> k0_thickness;
    for (const Layer& layer : layers) {
        media.push_back(medium(Complex(layer.n, layer.k)));
        k0_thickness.push_back(2.0L * std::numbers::pi_v<Real> / static_cast<Real>(lambda) *
                               static_cast<Real>(layer.thickness));
    }
    if (!from_outside) {
        std::ranges::reverse(media);
        std::ranges::reverse(k0_thickness);
    }
    const Medium first = medium(from_outside ? outside : base), last = medium(from_outside ? base : outside);
    const Share s = share(first, q0, media, k0_thickness, last, true);
    const Share p = share(first, q0, media, k0_thickness, last, false);
    return {s.reflected, p.reflected, s.transmitted, p.transmitted};
}

} // namespace tristim::oracle
