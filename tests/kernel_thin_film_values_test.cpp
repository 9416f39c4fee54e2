// film_optics of kernels/thin_film.h against published values.

#include "kernel_harness.h"
#include "thin_film_kernel.h"

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>

namespace tristim {
namespace {

using namespace kernel_test;
using oracle::FilmOptics;
using oracle::Layer;
using std::numbers::pi;

constexpr double bound = 5e-6; // promised for films up to 2 µm

struct Design {
    std::vector<Layer> layers;
    double base_n = 1.0, base_k = 0.0;
    double lambda = 550.0;
    double degrees = 0.0;
    double n0 = 1.0;
};

std::vector<FilmOptics> evaluate(const std::vector<Design>& designs) {
    const FilmProgram program;
    std::vector<FilmCase> cases;
    for (const Design& design : designs) {
        FilmSlot slot;
        slot.lambda = static_cast<float>(design.lambda);
        slot.n0 = static_cast<float>(design.n0);
        slot.base_n = static_cast<float>(design.base_n);
        slot.base_k = static_cast<float>(design.base_k);
        slot.cos_i = static_cast<float>(std::cos(design.degrees * pi / 180.0));
        FilmCase film{"", {}, true, {}};
        for (const Layer& layer : design.layers) {
            film.thickness.push_back(static_cast<float>(layer.thickness));
            slot.n.push_back(static_cast<float>(layer.n));
            slot.k.push_back(static_cast<float>(layer.k));
        }
        film.slots.assign(film_slots(program), slot);
        cases.push_back(film);
    }
    std::vector<FilmOptics> results;
    for (const std::vector<FilmOptics>& result : evaluate_films(program, cases))
        results.push_back(result.front());
    return results;
}

FilmOptics evaluate(const Design& design) {
    return evaluate(std::vector<Design>{design}).front();
}

double mean_reflected(const FilmOptics& optics) {
    return 0.5 * (optics.reflected_s + optics.reflected_p);
}

Layer quarter_wave(double n, double lambda) {
    return {lambda / (4.0 * n), n, 0.0};
}

/// Glass of index 1.52 reflects 4.26 % bare and 1.26 % under a quarter wave of MgF2, 1.38 (Macleod 2010, Thin-Film
/// Optical Filters, 2.4 and 4.1; Hecht 2002, Optics, 9.7.2: 1.3 %).
TEST(KernelThinFilmValues, MagnesiumFluorideOnGlass) {
    EXPECT_NEAR(mean_reflected(evaluate({{}, 1.52})), 0.0426, 0.00005);
    EXPECT_NEAR(mean_reflected(evaluate({{quarter_wave(1.38, 550.0)}, 1.52})), 0.0126, 0.00005);
    // Away from its design wavelength a coating reflects more, but no more than bare glass.
    for (const double lambda : {380.0, 420.0, 480.0, 620.0, 780.0}) {
        const double r = mean_reflected(evaluate({{quarter_wave(1.38, 550.0)}, 1.52, 0.0, lambda}));
        EXPECT_GT(r, 0.0127) << lambda;
        EXPECT_LT(r, 0.0426) << lambda;
    }
    // And vanishes on glass of the square of its index: Hecht's condition n1² = n0 ns.
    EXPECT_NEAR(mean_reflected(evaluate({{quarter_wave(1.38, 550.0)}, 1.38 * 1.38})), 0.0, bound);
}

/// Byrnes 2016 (arXiv:1603.02720), tests of the package tmm, computed there by an independent program in Mathematica:
/// layers 2 + 4i and 3 + 0.3i, 2 and 3 nm thick, on 1 + 0.1i, at 100 nm and 0.1 rad.
TEST(KernelThinFilmValues, AbsorbingStackOfByrnes) {
    const FilmOptics optics = evaluate({{{2.0, 2.0, 4.0}, {3.0, 3.0, 0.3}}, 1.0, 0.1, 100.0, 0.1 * 180.0 / pi});
    EXPECT_NEAR(optics.reflected_s, 0.37273208839139516, bound);
    EXPECT_NEAR(optics.transmitted_s, 0.22604491247079261, bound);
    EXPECT_NEAR(optics.reflected_p, 0.37016110373044969, bound);
    EXPECT_NEAR(optics.transmitted_p, 0.22824374314132009, bound);
}

/// With pairs of quarter waves of 2.5 and 1.5 on glass of 1.5, a reflectance of 99.5 % needs 6.94 of them, so seven
/// (University of Tennessee, Physics 507, assignment 3).
TEST(KernelThinFilmValues, PairsOfABraggMirror) {
    std::vector<Layer> layers;
    for (int pairs = 1; pairs <= 7; ++pairs) {
        layers.insert(layers.begin(), {quarter_wave(2.5, 550.0), quarter_wave(1.5, 550.0)});
        const double r = mean_reflected(evaluate({layers, 1.5}));
        EXPECT_EQ(r >= 0.995, pairs >= 7) << pairs << " pairs: " << r;
        // Macleod 2010, 6.1: the peak is that of the admittance n_s (n_H/n_L)^2N.
        const double admittance = 1.5 * std::pow(2.5 / 1.5, 2 * pairs);
        EXPECT_NEAR(r, std::pow((1.0 - admittance) / (1.0 + admittance), 2), bound) << pairs << " pairs";
    }
}

/// The stop band of quarter waves n_H and n_L reaches from λ0/(1 + Δg) to λ0/(1 - Δg), Δg = (2/π) asin((n_H - n_L)/(n_H
/// + n_L)) (Macleod 2010, 6.1.1); at its edges N periods reflect C²/(C² + 1/N²), C the matrix element of one (Yeh 1988,
/// Optical Waves in Layered Media, 6.3), more within and less just beyond.
TEST(KernelThinFilmValues, StopBandOfABraggMirror) {
    constexpr double high = 2.35, low = 1.46, centre = 550.0;
    constexpr int periods = 12;
    std::vector<Layer> layers;
    for (int i = 0; i < periods; ++i)
        layers.insert(layers.end(), {quarter_wave(high, centre), quarter_wave(low, centre)});
    const auto at = [&](double lambda) { return Design{layers, low, 0.0, lambda, 0.0, low}; };
    const double half_width = 2.0 / pi * std::asin((high - low) / (high + low));
    std::vector<double> edges{centre / (1.0 + half_width), centre / (1.0 - half_width)};
    EXPECT_NEAR(edges[0], 478.2, 0.05);
    EXPECT_NEAR(edges[1], 647.1, 0.05);
    std::vector<double> reflected_at_edges;
    for (const double edge : edges) {
        const double element = 0.5 * (high / low - low / high) * std::sin(0.5 * pi * centre / edge);
        const double expected = element * element / (element * element + 1.0 / (periods * periods));
        reflected_at_edges.push_back(mean_reflected(evaluate(at(edge))));
        // The edge in float is off by up to 3e-5 nm, over which the reflectance changes by less than 1e-5.
        EXPECT_NEAR(reflected_at_edges.back(), expected, bound + 1e-5) << edge;
    }
    std::vector<Design> inside;
    for (double lambda = edges[0] + 0.1; lambda < edges[1]; lambda += 0.5)
        inside.push_back(at(lambda));
    for (const FilmOptics& optics : evaluate(inside))
        EXPECT_GT(mean_reflected(optics), std::min(reflected_at_edges[0], reflected_at_edges[1]));
    EXPECT_LT(mean_reflected(evaluate(at(edges[0] - 1.0))), reflected_at_edges[0]);
    EXPECT_LT(mean_reflected(evaluate(at(edges[1] + 1.0))), reflected_at_edges[1]);
}

/// A soap film (water, 1.33) is black where it vanishes and where it is half waves thick, and reflects ((n² - 1)/(n² +
/// 1))² = 7.7 % where it is odd quarter waves thick (Isenberg 1992, The Science of Soap Films and Soap Bubbles, 3.2).
TEST(KernelThinFilmValues, SoapFilm) {
    constexpr double n = 1.33;
    for (const double lambda : {400.0, 550.0, 700.0}) {
        for (int order = 0; order < 4; ++order) {
            const double bright = (2 * order + 1) * lambda / (4.0 * n), dark = 2 * order * lambda / (4.0 * n);
            EXPECT_NEAR(mean_reflected(evaluate({{{bright, n, 0.0}}, 1.0, 0.0, lambda})), 0.0771, 0.00005);
            EXPECT_NEAR(mean_reflected(evaluate({{{dark, n, 0.0}}, 1.0, 0.0, lambda})), 0.0, bound);
        }
        // Newton's black film, some 5 nm: ((n² - 1)/n · π n d/λ)² of the light, 0.03 to 0.1 %.
        const double black = std::pow((n * n - 1.0) * pi * 5.0 / lambda, 2);
        EXPECT_NEAR(mean_reflected(evaluate({{{5.0, n, 0.0}}, 1.0, 0.0, lambda})) / black, 1.0, 0.01);
    }
}

/// Crown glass polarises at 56.3° (Hecht 2002, 8.6.1): no p there, and ((n² - 1)/(n² + 1))² of s, 14.8 %.
TEST(KernelThinFilmValues, BrewstersAngle) {
    const FilmOptics optics = evaluate({{}, 1.5, 0.0, 550.0, std::atan(1.5) * 180.0 / pi});
    EXPECT_NEAR(std::atan(1.5) * 180.0 / pi, 56.3, 0.05);
    EXPECT_NEAR(optics.reflected_p, 0.0, bound);
    EXPECT_NEAR(optics.transmitted_p, 1.0, bound);
    EXPECT_NEAR(optics.reflected_s, 0.148, 0.0005);
}

/// Metals at 589 nm, n, k and R (Born & Wolf 1999, table 14.1), and a film of each too thick to see through on glass.
TEST(KernelThinFilmValues, Metals) {
    struct Metal {
        const char* name;
        double n, k, reflectance;
    };
    for (const Metal& metal : {Metal{"silver", 0.20, 3.44, 0.94}, Metal{"magnesium", 0.37, 4.42, 0.93},
                               Metal{"gold", 0.47, 2.83, 0.82}, Metal{"aluminium", 1.44, 5.23, 0.83}}) {
        const FilmOptics solid = evaluate({{}, metal.n, metal.k, 589.3});
        EXPECT_NEAR(mean_reflected(solid), metal.reflectance, 0.005) << metal.name;
        EXPECT_NEAR(solid.transmitted_s, 1.0 - solid.reflected_s, bound) << metal.name;
        const FilmOptics film = evaluate({{{400.0, metal.n, metal.k}}, 1.52, 0.0, 589.3});
        EXPECT_NEAR(mean_reflected(film), metal.reflectance, 0.005) << metal.name;
        EXPECT_LT(film.transmitted_s, 1e-5) << metal.name;
    }
}

} // namespace
} // namespace tristim
