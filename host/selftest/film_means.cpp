#include "selftest/film_means.h"

#include "selftest/film_inputs.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace tristim::selftest {
namespace {

constexpr double from_nm = 380.0, to_nm = 780.0;

double reflected(const oracle::FilmOptics& optics) {
    return 0.5 * (optics.reflected_s + optics.reflected_p);
}

double exactly_reflected(const FilmPoint& film, double lambda, double cosine) {
    std::vector<oracle::Layer> layers;
    for (const FilmPoint::Layer& layer : film.layers)
        layers.push_back({layer.thickness, layer.n, layer.k});
    return reflected(oracle::film(film.n0, layers, film.base_n, film.base_k, lambda, cosine, film.from_outside));
}

/// ∫ R(μ) 2μ dμ over the cosines of light in the base, in two parts that meet at the critical angle, where R has a
/// corner; as at both ends, nodes lie dense there: μ = a + (b - a) x² (3 - 2x).
double exact_internal_reflectance(const FilmPoint& film) {
    const double n = film.base_n, critical = std::sqrt(std::max(0.0, (1.0 - 1.0 / n) * (1.0 + 1.0 / n)));
    double half_turns = 0.0;
    for (const FilmPoint::Layer& layer : film.layers)
        half_turns += 2.0 * layer.thickness * layer.n / film.lambda;
    const int nodes = 600 + static_cast<int>(8.0 * half_turns);
    double sum = 0.0;
    for (const auto& [begin, end] : {std::pair{0.0, critical}, std::pair{critical, 1.0}}) {
        for (int i = 0; i < nodes; ++i) {
            const double x = (i + 0.5) / nodes;
            const double mu = begin + (end - begin) * x * x * (3.0 - 2.0 * x);
            const double slope = (end - begin) * 6.0 * x * (1.0 - x);
            sum += exactly_reflected(film, film.lambda, mu) * 2.0 * mu * slope / nodes;
        }
    }
    return sum;
}

} // namespace

Measurement mean_over_wavelengths(FilmKernels& kernels, const Setting& setting) {
    constexpr int nodes = 4; // in each stratum, for the exact mean and the variance within
    constexpr double rounding = 1e-6;
    FilmDraw draw(20);
    Measurement found;
    const std::size_t strata = inputs(setting, 16384, 64);
    for (const double thickness : logarithmic_steps(1e3, 1e6, 1)) {
        for (const bool on_metal : {false, true}) {
            FilmPoint film;
            film.base_n = on_metal ? 0.9F : 4.0F;
            film.base_k = on_metal ? 6.4F : 0.03F;
            film.layers = {{static_cast<float>(thickness), 1.46F, 0.0F}};
            film.cos_i = on_metal ? 0.4F : 1.0F;
            std::vector<FilmPoint> points(strata, film);
            double mean = 0.0, variance = 0.0;
            const double width = (to_nm - from_nm) / static_cast<double>(strata);
            for (std::size_t i = 0; i < strata; ++i) {
                const double begin = from_nm + width * static_cast<double>(i);
                points[i].lambda = static_cast<float>(begin + width * draw(0.0, 1.0));
                double sum = 0.0, squares = 0.0;
                for (int node = 0; node < nodes; ++node) {
                    const double r = exactly_reflected(film, begin + width * (node + 0.5) / nodes, film.cos_i);
                    sum += r / nodes;
                    squares += r * r / nodes;
                }
                mean += sum / static_cast<double>(strata);
                variance += (squares - sum * sum) / static_cast<double>(strata * strata);
            }
            for (const bool absorbing : {true, false}) {
                double measured = 0.0;
                for (const oracle::FilmOptics& answer : kernels.optics(setting, points, absorbing))
                    measured += reflected(answer) / static_cast<double>(strata);
                const double standard_error = std::sqrt(std::max(variance, 0.0)) + rounding;
                found.add(thickness, std::abs(measured - mean) / standard_error, [&] {
                    return fmt::format("{} nm of index 1.46 on {}+{}i at cosine {}: {:.7f} instead of {:.7f} ± {:.1g}",
                                       thickness, film.base_n, film.base_k, film.cos_i, measured, mean, standard_error);
                });
            }
        }
    }
    return found;
}

Measurement internal_reflectance(FilmKernels& kernels, const Setting& setting, const InternalFilms& films) {
    FilmDraw draw(21);
    std::vector<FilmPoint> points;
    std::vector<double> thicknesses = logarithmic_steps(std::max(films.thinnest, 1e-3), films.thickest, 2);
    constexpr double slow = 2e4; // nm; what lies above is tried the less often, the more nodes the quadrature needs
    if (films.thinnest == 0.0)
        thicknesses.insert(thicknesses.begin(), 0.0);
    for (const double thickness : thicknesses) {
        for (std::size_t i = 0; i < inputs(setting, thickness <= slow ? 24 : 4, 1); ++i) {
            FilmPoint film;
            film.lambda = static_cast<float>(draw(from_nm, to_nm));
            film.from_outside = false;
            film.base_n = draw.once_in(8) ? 1.0F : static_cast<float>(draw(1.0, 2.5));
            film.layers = {{static_cast<float>(thickness), static_cast<float>(draw(1.1, 2.6)),
                            films.absorbing ? static_cast<float>(draw.logarithmic(1e-6, 3.0)) : 0.0F}};
            points.push_back(film);
        }
    }
    std::vector<double> exact;
    for (const FilmPoint& point : points)
        exact.push_back(exact_internal_reflectance(point));
    Measurement found;
    for (const bool code : {true, false}) {
        if (films.absorbing && !code)
            continue;
        const std::vector<double> answers =
            kernels.internal_reflectances(setting, points, code, films.most_quadrature_points);
        for (std::size_t i = 0; i < points.size(); ++i)
            found.add(points[i].layers[0].thickness, std::abs(answers[i] - exact[i]), [&] {
                return fmt::format("{}, {} code for absorbing layers: {:.7f} instead of {:.7f}", describe(points[i]),
                                   code ? "with" : "without", answers[i], exact[i]);
            });
    }
    return found;
}

} // namespace tristim::selftest
