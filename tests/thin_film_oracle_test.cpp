// The oracle for thin films against closed forms.

#include "selftest/film_oracle.h"

#include <cmath>
#include <complex>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

namespace tristim::oracle {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

constexpr double precision = 1e-11; // double rounding through phases of up to some 1e4 radians

/// √(n² - n0² sin² θ), the wave that decays or travels downwards.
Complex normal_index(Complex n, double n0, double cos_i) {
    const Complex q = std::sqrt(n * n - n0 * n0 * (1.0 - cos_i) * (1.0 + cos_i));
    return q.imag() < 0.0 ? -q : q;
}

double degrees(double angle) {
    return std::cos(angle * pi / 180.0);
}

class Random {
  public:
    double operator()(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
    int below(int count) { return std::uniform_int_distribution<int>(0, count - 1)(engine_); }

  private:
    std::mt19937 engine_{7};
};

std::vector<Layer> random_stack(Random& random, int count, double thickest, double largest_k) {
    std::vector<Layer> layers;
    for (int i = 0; i < count; ++i)
        layers.push_back(
            {random(0.0, thickest), random(0.8, 3.0), random.below(2) == 0 ? 0.0 : random(0.0, largest_k)});
    return layers;
}

void expect_same(const FilmOptics& a, const FilmOptics& b, double tolerance, const std::string& at) {
    EXPECT_NEAR(a.reflected_s, b.reflected_s, tolerance) << at;
    EXPECT_NEAR(a.reflected_p, b.reflected_p, tolerance) << at;
    EXPECT_NEAR(a.transmitted_s, b.transmitted_s, tolerance) << at;
    EXPECT_NEAR(a.transmitted_p, b.transmitted_p, tolerance) << at;
}

/// Fresnel's equations (Born & Wolf 1999, 1.5.2 and 14.2), without layers and through layers of no thickness or of the
/// index of either side.
TEST(ThinFilmOracle, BareInterface) {
    for (const double n0 : {1.0, 1.5})
        for (const Complex n : {Complex(1.5, 0.0), Complex(1.0, 0.0), Complex(2.4, 0.0), Complex(0.05, 4.0),
                                Complex(1.2, 7.0), Complex(4.0, 0.03)})
            for (const double angle : {0.0, 10.0, 33.0, 41.9, 56.3, 80.0, 89.9}) {
                const double c = degrees(angle);
                const Complex q = normal_index(n, n0, c);
                const double s = std::norm((n0 * c - q) / (n0 * c + q));
                const double p = std::norm((n * n * c - n0 * q) / (n * n * c + n0 * q));
                const FilmOptics expected{s, p, 1.0 - s, 1.0 - p};
                const std::string at = fmt::format("{} on {} + {}i, {}°", n0, n.real(), n.imag(), angle);
                expect_same(film(n0, {}, n.real(), n.imag(), 500.0, c, true), expected, precision, at);
                expect_same(film(n0, {{0.0, 2.0, 1.0}, {0.0, 1.1, 0.0}}, n.real(), n.imag(), 500.0, c, true), expected,
                            precision, at + ", no thickness");
                expect_same(film(n0, {{5000.0, n0, 0.0}}, n.real(), n.imag(), 500.0, c, true), expected, precision,
                            at + ", layer like the outside");
                // Below the interface power decays by exp(-2 Im(q) k0 d).
                const double decay = std::exp(-4.0 * pi / 500.0 * q.imag() * 20.0);
                expect_same(film(n0, {{20.0, n.real(), n.imag()}}, n.real(), n.imag(), 500.0, c, true),
                            {s, p, (1.0 - s) * decay, (1.0 - p) * decay}, precision, at + ", layer like the base");
            }
}

/// Airy's sum of one layer (Born & Wolf 1999, 7.6.1; amplitudes at each face by Fresnel's equations).
TEST(ThinFilmOracle, OneLayer) {
    Random random;
    for (int i = 0; i < 20000; ++i) {
        const double n0 = random(1.0, 2.0), lambda = random(380.0, 780.0), thickness = random(0.0, 3000.0);
        const double c = degrees(random(0.0, 89.9));
        const Complex n1(random(0.1, 4.0), i % 2 == 0 ? 0.0 : random(0.0, 2.0));
        const Complex n2(random(0.1, 4.0), i % 3 == 0 ? 0.0 : random(0.0, 6.0));
        const Complex q0 = n0 * c, q1 = normal_index(n1, n0, c), q2 = normal_index(n2, n0, c);
        const Complex phase = std::exp(Complex(0.0, 2.0 * pi / lambda * thickness) * q1);
        const auto airy = [&](Complex y0, Complex y1, Complex y2) { // admittances
            const Complex r01 = (y0 - y1) / (y0 + y1), r12 = (y1 - y2) / (y1 + y2);
            const Complex round_trip = 1.0 + r01 * r12 * phase * phase;
            const Complex t = 4.0 * y0 * y1 / ((y0 + y1) * (y1 + y2)) * phase / round_trip;
            return std::pair(std::norm((r01 + r12 * phase * phase) / round_trip), y2.real() / y0.real() * std::norm(t));
        };
        const auto [rs, ts] = airy(q0, q1, q2);
        const auto [rp, tp] = airy(n0 * n0 / q0, n1 * n1 / q1, n2 * n2 / q2);
        const FilmOptics optics = film(n0, {{thickness, n1.real(), n1.imag()}}, n2.real(), n2.imag(), lambda, c, true);
        // The formula's own rounding: 1e-15 of a phase of up to 200 radians, and a root that cancels near a critical
        // angle.
        const double conditioning = 1.0 / std::min({1.0, std::abs(q1), std::abs(q2), c});
        expect_same(optics, {rs, rp, ts, tp}, precision * conditioning,
                    fmt::format("{} | {} nm of {} + {}i | {} + {}i, cos {}, {} nm", n0, thickness, n1.real(), n1.imag(),
                                n2.real(), n2.imag(), c, lambda));
    }
}

/// Quarter waves of H and L in turn, N pairs: admittance n_s (n_H/n_L)^2N (Macleod 2010, Thin-Film Optical Filters,
/// 6.1).
TEST(ThinFilmOracle, QuarterWaveStack) {
    const double high = 2.35, low = 1.38, glass = 1.52;
    std::vector<Layer> layers;
    for (int pairs = 0; pairs <= 20; ++pairs) {
        const double admittance = glass * std::pow(high / low, 2 * pairs);
        const double r = (1.0 - admittance) / (1.0 + admittance);
        const FilmOptics optics = film(1.0, layers, glass, 0.0, 550.0, 1.0, true);
        const double transmitted = 4.0 * admittance / ((1.0 + admittance) * (1.0 + admittance));
        expect_same(optics, {r * r, r * r, transmitted, transmitted}, 1e-14, fmt::format("{} pairs", pairs));
        EXPECT_NEAR(optics.transmitted_s / transmitted, 1.0, 1e-12) << pairs << " pairs";
        layers.insert(layers.begin(), {{550.0 / 4.0 / high, high, 0.0}, {550.0 / 4.0 / low, low, 0.0}});
    }
}

/// A periodic medium's reflectance (Yeh 1988, Optical Waves in Layered Media, 6.3): with the matrix element C of a
/// period and Bloch's phase K, R = |C|²/(|C|² + (sin K/sin N K)²), in and out of the stop band, for s at an angle.
TEST(ThinFilmOracle, PeriodicStack) {
    const double n0 = 1.5, n1 = 1.5, n2 = 2.3, d1 = 110.0, d2 = 63.0;
    for (int periods = 1; periods <= 20; ++periods)
        for (const double angle : {0.0, 25.0, 60.0})
            for (double lambda = 380.0; lambda <= 780.0; lambda += 9.7) {
                const double c = degrees(angle), q1 = n1 * c, q2 = normal_index(n2, n0, c).real();
                const double phi1 = 2.0 * pi / lambda * q1 * d1, phi2 = 2.0 * pi / lambda * q2 * d2;
                const double element = 0.5 * (q2 / q1 - q1 / q2) * std::sin(phi2); // |C|
                const Complex bloch = std::acos(Complex(std::cos(phi1) * std::cos(phi2) -
                                                        0.5 * (q1 / q2 + q2 / q1) * std::sin(phi1) * std::sin(phi2)));
                const double ratio = std::norm(std::sin(bloch) / std::sin(static_cast<double>(periods) * bloch));
                const double reflectance = element * element / (element * element + ratio);
                std::vector<Layer> layers;
                for (int i = 0; i < periods; ++i)
                    layers.insert(layers.end(), {{d1, n1, 0.0}, {d2, n2, 0.0}});
                EXPECT_NEAR(film(n0, layers, n0, 0.0, lambda, c, true).reflected_s, reflectance, precision)
                    << periods << " periods, " << angle << "°, " << lambda << " nm";
            }
}

/// Through a gap of low index between two media of index n (Court & von Willisen 1964, Appl. Opt. 3, 719): 1/T = 1 +
/// (y² + w²)²/(2yw)² sinh²(k0 κ d), with y = n cos θ, w = κ = √(n² sin² θ - n_gap²) for s and y/n², w/n_gap² for p.
TEST(ThinFilmOracle, FrustratedTotalReflection) {
    const double n = 1.52, gap = 1.0, lambda = 633.0;
    for (const double angle : {41.2, 42.0, 45.0, 60.0, 85.0})
        for (const double thickness : {1.0, 10.0, 100.0, 300.0, 1000.0, 3000.0}) {
            const double c = degrees(angle), q = n * c, kappa = std::sqrt(n * n * (1.0 - c * c) - gap * gap);
            const auto transmitted = [&](double y, double w) {
                const double sinh = std::sinh(2.0 * pi / lambda * kappa * thickness);
                const double weight = (y * y + w * w) / (2.0 * y * w);
                return 1.0 / (1.0 + weight * weight * sinh * sinh);
            };
            const double s = transmitted(q, kappa), p = transmitted(q / (n * n), kappa / (gap * gap));
            const std::string at = fmt::format("{}°, {} nm", angle, thickness);
            for (const bool from_outside : {false, true})
                expect_same(film(n, {{thickness, gap, 0.0}}, n, 0.0, lambda, c, from_outside), {1.0 - s, 1.0 - p, s, p},
                            precision, at);
            EXPECT_NEAR(film(n, {{thickness, gap, 0.0}}, n, 0.0, lambda, c, true).transmitted_p / p, 1.0, 1e-9) << at;
        }
}

TEST(ThinFilmOracle, TotalReflection) {
    Random random;
    for (int i = 0; i < 300; ++i) {
        std::vector<Layer> layers = random_stack(random, random.below(41), 100'000.0, 0.0);
        const double base = random(1.2, 2.0), c = std::sqrt(1.0 - 1.0 / (base * base)) * random(0.0, 0.999999);
        expect_same(film(1.0, layers, base, 0.0, random(380.0, 780.0), c, false), {1.0, 1.0, 0.0, 0.0}, 1e-12,
                    fmt::format("stack {}", i));
    }
}

TEST(ThinFilmOracle, PowerIsConserved) {
    Random random;
    for (int i = 0; i < 500; ++i) {
        const bool lossless = i % 2 == 0;
        const std::vector<Layer> layers = random_stack(random, random.below(41), 1000.0, lossless ? 0.0 : 3.0);
        const double base_n = random(0.1, 4.0), base_k = lossless ? 0.0 : random(0.0, 5.0);
        const double c = degrees(random(0.0, 89.9)), lambda = random(380.0, 780.0);
        const FilmOptics optics = film(1.0, layers, base_n, base_k, lambda, c, true);
        for (const double sum :
             {optics.reflected_s + optics.transmitted_s, optics.reflected_p + optics.transmitted_p}) {
            EXPECT_LE(sum, 1.0 + precision) << i;
            if (lossless) {
                EXPECT_GE(sum, 1.0 - precision) << i;
            }
        }
    }
}

/// Transmittance is the same both ways along a path between lossless media, absorption in between or not (Born & Wolf
/// 1999, 1.6.4; Knittl 1976, Optics of Thin Films, 2.4).
TEST(ThinFilmOracle, TransmittanceIsReciprocal) {
    Random random;
    for (int i = 0; i < 500; ++i) {
        const std::vector<Layer> layers = random_stack(random, random.below(41), 500.0, i % 2 == 0 ? 0.0 : 0.5);
        const double n0 = random(1.0, 1.5), base = random(1.5, 3.0), lambda = random(380.0, 780.0);
        const double c = degrees(random(0.0, 89.0));
        const FilmOptics down = film(n0, layers, base, 0.0, lambda, c, true);
        const FilmOptics up = film(n0, layers, base, 0.0, lambda, normal_index(base, n0, c).real() / base, false);
        EXPECT_NEAR(down.transmitted_s, up.transmitted_s, precision) << i;
        EXPECT_NEAR(down.transmitted_p, up.transmitted_p, precision) << i;
    }
}

/// Cutting a layer in two changes nothing; limits stay finite.
TEST(ThinFilmOracle, LayersMayBeCut) {
    Random random;
    for (int i = 0; i < 300; ++i) {
        const std::vector<Layer> layers = random_stack(random, 1 + random.below(20), 100'000.0, 5.0);
        std::vector<Layer> cut;
        for (const Layer& layer : layers) {
            const double part = random(0.0, 1.0);
            cut.push_back({layer.thickness * part, layer.n, layer.k});
            cut.push_back({layer.thickness - cut.back().thickness, layer.n, layer.k});
        }
        const double c = i % 3 == 0 ? 0.0 : degrees(random(0.0, 89.9)), base_k = random(0.0, 5.0);
        const FilmOptics whole = film(1.0, layers, 1.5, base_k, 550.0, c, true);
        expect_same(whole, film(1.0, cut, 1.5, base_k, 550.0, c, true), 1e-9, fmt::format("stack {}", i));
        if (c == 0.0)
            expect_same(whole, {1.0, 1.0, 0.0, 0.0}, 1e-9, fmt::format("grazing stack {}", i));
    }
}

} // namespace
} // namespace tristim::oracle
