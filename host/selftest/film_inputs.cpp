#include "selftest/film_inputs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <numbers>

namespace tristim::selftest {
namespace {

constexpr std::size_t together = 8; // points that differ in all but thickness and direction: one work-item's
constexpr double degree = std::numbers::pi / 180.0;

struct Index {
    double n = 1.0, k = 0.0;
};

/// Silver, aluminium and titanium in the green, and a stronger absorber.
constexpr std::array<Index, 4> metals{{{0.06, 3.4}, {0.9, 6.4}, {2.2, 2.9}, {4.0, 9.0}}};

Index clear_index(FilmDraw& draw) {
    return {draw(1.0, 3.0), 0.0};
}
Index absorbing_index(FilmDraw& draw) {
    if (draw.once_in(2))
        return metals[draw.below(metals.size())];
    return {draw(1.0, 3.0), draw.logarithmic(1e-6, 1.0)};
}

FilmPoint::Layer layer_of(double thickness, const Index& index) {
    return {static_cast<float>(thickness), static_cast<float>(index.n), static_cast<float>(index.k)};
}
void set_base(FilmPoint& film, const Index& index) {
    film.base_n = static_cast<float>(index.n);
    film.base_k = static_cast<float>(index.k);
}

/// Clear bases, seen from either side, and absorbing ones.
void draw_base(FilmDraw& draw, FilmPoint& film) {
    set_base(film, draw.once_in(3) ? absorbing_index(draw) : clear_index(draw));
    film.from_outside = film.base_k > 0.0F || draw.once_in(2);
}

float cosine(double degrees) {
    return static_cast<float>(std::cos(degrees * degree));
}

/// Points for one work-item: the film at other wavelengths, as `vary` changes it further.
void add_together(std::vector<FilmInput>& inputs, double parameter, FilmDraw& draw, const FilmPoint& film,
                  const std::function<void(FilmPoint&)>& vary) {
    for (std::size_t i = 0; i < together; ++i) {
        FilmInput& input = inputs.emplace_back();
        input = {parameter, film};
        input.point.lambda = static_cast<float>(draw(380.0, 780.0));
        vary(input.point);
    }
}

/// The cosine of an angle whose sine is given.
float cosine_of_sine(double sine) {
    return static_cast<float>(std::sqrt(std::max(0.0, (1.0 - sine) * (1.0 + sine))));
}

std::vector<double> counts_up_to_100() {
    return {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 15, 16, 17, 20, 24, 30, 40, 50, 60, 70, 80, 90, 99, 100};
}

} // namespace

double FilmDraw::logarithmic(double low, double high) {
    return std::exp((*this)(std::log(low), std::log(high)));
}

std::vector<double> logarithmic_steps(double low, double high, int per_decade) {
    std::vector<double> steps;
    for (int i = 0; low * std::pow(10.0, static_cast<double>(i) / per_decade) < 0.999 * high; ++i)
        steps.push_back(low * std::pow(10.0, static_cast<double>(i) / per_decade));
    steps.push_back(high);
    return steps;
}

std::vector<FilmInput> thickness_inputs(const Setting& setting, double low, double high) {
    FilmDraw draw(1);
    std::vector<FilmInput> films;
    std::vector<double> steps = logarithmic_steps(std::max(low, 1e-3), high, 6);
    if (low == 0.0)
        steps.insert(steps.begin(), 0.0);
    for (const double thickness : steps) {
        for (std::size_t i = 0; i < inputs(setting, 100, 2); ++i) {
            FilmPoint film;
            film.n0 = draw.once_in(3) ? static_cast<float>(draw(1.0, 2.0)) : 1.0F;
            draw_base(draw, film);
            const Index index = i % 2 == 0 ? clear_index(draw) : absorbing_index(draw);
            const double share = draw(0.0, 1.0);
            film.layers = {layer_of(thickness, index)};
            if (draw.once_in(4))
                film.layers = {layer_of(share * thickness, index),
                               layer_of((1.0 - share) * thickness, clear_index(draw))};
            add_together(films, thickness, draw, film, [&](FilmPoint& p) { p.cos_i = cosine(draw(0.0, 89.9)); });
        }
    }
    return films;
}

std::vector<FilmInput> angle_inputs(const Setting& setting) {
    FilmDraw draw(2);
    std::vector<FilmInput> films;
    std::vector<double> steps = logarithmic_steps(1e-4, 10.0, 4);
    for (const double more : {0.0, 20.0, 30.0, 34.0, 40.0, 50.0, 60.0, 75.0, 85.0, 89.0, 89.9, 89.999, 90.0})
        steps.push_back(more);
    for (const double from_grazing : steps) {
        for (std::size_t i = 0; i < inputs(setting, 100, 2); ++i) {
            FilmPoint film;
            draw_base(draw, film);
            const std::size_t layers = draw.below(5);
            for (std::size_t j = 0; j < layers; ++j)
                film.layers.push_back(layer_of(draw(0.0, 2000.0 / static_cast<double>(layers)),
                                               draw.once_in(3) ? absorbing_index(draw) : clear_index(draw)));
            add_together(films, from_grazing, draw, film,
                         [&](FilmPoint& p) { p.cos_i = static_cast<float>(std::sin(from_grazing * degree)); });
        }
    }
    return films;
}

std::vector<FilmInput> total_reflection_inputs(const Setting& setting) {
    FilmDraw draw(3);
    std::vector<FilmInput> films;
    std::vector<double> steps{0.0};
    for (const double distance : logarithmic_steps(1e-8, 1e-2, 2)) {
        steps.push_back(distance);
        steps.push_back(-distance);
    }
    for (const double distance : steps) {
        for (std::size_t i = 0; i < inputs(setting, 100, 3); ++i) {
            FilmPoint film;
            film.from_outside = draw.once_in(2);
            const double dense = draw(1.3, 3.0);
            const auto rare = static_cast<float>(draw(1.0, 0.95 * dense));
            // The rare medium lies at the far side (0), is a single layer (1) or one between others (2).
            const std::size_t kind = i % 3;
            const double thickness = draw.once_in(4) ? 0.0 : draw.logarithmic(1e-3, 1e6);
            if (kind > 0)
                film.layers = {layer_of(thickness, {rare, 0.0})};
            if (kind != 1) {
                film.layers.insert(film.layers.begin(), layer_of(draw(0.0, 300.0), clear_index(draw)));
                film.layers.push_back(layer_of(draw(0.0, 300.0), clear_index(draw)));
            }
            const float incident = static_cast<float>(dense);
            const auto other = static_cast<float>(kind == 0 ? rare : draw(1.0, 3.0));
            film.n0 = film.from_outside ? incident : other;
            film.base_n = film.from_outside ? other : incident;
            const double sine = double{rare} / double{incident} * (1.0 + distance);
            film.cos_i = cosine_of_sine(std::min(sine, 1.0));
            add_together(films, distance, draw, film, [](FilmPoint&) {});
        }
    }
    return films;
}

std::vector<FilmInput> matched_inputs(const Setting& setting) {
    FilmDraw draw(4);
    std::vector<FilmInput> films;
    std::vector<double> steps = logarithmic_steps(1e-7, 1e-3, 2);
    steps.insert(steps.begin(), {0.0, 6e-8});
    for (const double difference : steps) {
        for (std::size_t i = 0; i < inputs(setting, 150, 3); ++i) {
            FilmPoint film;
            film.from_outside = draw.once_in(2);
            film.n0 = draw.once_in(2) ? 1.0F : static_cast<float>(draw(1.0, 2.5));
            // The layer matches the outside (0), the base (1) or both (2).
            const std::size_t kind = i % 3;
            const auto near = [&](float n) {
                if (difference == 6e-8)
                    return std::nextafter(n, draw.once_in(2) ? 4.0F : 0.0F);
                return static_cast<float>(n * (1.0 + (draw.once_in(2) ? difference : -difference)));
            };
            film.base_n = kind == 2 ? near(film.n0) : static_cast<float>(draw(1.0, 2.5));
            const float layer = near(kind == 1 ? film.base_n : film.n0);
            film.layers = {{static_cast<float>(draw.once_in(4) ? 0.0 : draw.logarithmic(1e-3, 1e6)), layer, 0.0F}};
            add_together(films, difference, draw, film, [&](FilmPoint& p) {
                const double grazing = draw.logarithmic(1e-4, 90.0);
                p.cos_i = draw.once_in(8) ? 0.0F : static_cast<float>(std::sin(grazing * degree));
            });
        }
    }
    return films;
}

std::vector<FilmInput> absorption_inputs(const Setting& setting, double low, double high) {
    FilmDraw draw(5);
    std::vector<FilmInput> films;
    for (const double k : logarithmic_steps(low, high, 3)) {
        for (std::size_t i = 0; i < inputs(setting, 150, 3); ++i) {
            FilmPoint film;
            const Index index{draw.once_in(2) ? draw(0.05, 4.0) : draw.logarithmic(1e-3, 1.0), k};
            const double thickness = draw.once_in(8) ? 0.0 : draw.logarithmic(1e-3, 1e6);
            // The base absorbs (0), the layer does (1) or both do (2).
            const std::size_t kind = i % 3;
            draw_base(draw, film);
            if (kind != 1) {
                set_base(film, index);
                film.from_outside = true;
            }
            film.layers = {layer_of(thickness, kind == 0 ? clear_index(draw) : index)};
            if (kind == 2 && draw.once_in(2))
                film.layers.push_back(layer_of(draw(0.0, 300.0), clear_index(draw)));
            add_together(films, k, draw, film, [&](FilmPoint& p) { p.cos_i = cosine(draw(0.0, 89.9)); });
        }
    }
    return films;
}

std::vector<FilmInput> random_stack_inputs(const Setting& setting) {
    FilmDraw draw(6);
    std::vector<FilmInput> films;
    for (const double count : counts_up_to_100()) {
        for (std::size_t i = 0; i < inputs(setting, 30, 2); ++i) {
            FilmPoint film;
            draw_base(draw, film);
            double sum = 0.0;
            std::vector<double> thicknesses;
            for (int j = 0; j < static_cast<int>(count); ++j) {
                thicknesses.push_back(draw(0.0, 1.0));
                sum += thicknesses.back();
            }
            for (const double thickness : thicknesses)
                film.layers.push_back(layer_of(1999.0 * thickness / sum, i % 2 == 0 && draw.once_in(3)
                                                                             ? absorbing_index(draw)
                                                                             : clear_index(draw)));
            add_together(films, count, draw, film, [&](FilmPoint& p) { p.cos_i = cosine(draw(0.0, 89.9)); });
        }
    }
    return films;
}

std::vector<FilmInput> quarter_wave_inputs(const Setting& setting) {
    FilmDraw draw(7);
    std::vector<FilmInput> films;
    for (const double count : counts_up_to_100()) {
        for (std::size_t i = 0; i < inputs(setting, 30, 2); ++i) {
            FilmPoint film;
            draw_base(draw, film);
            const double k = i % 2 == 0 ? 0.0 : 1.0;
            for (int j = 0; j < static_cast<int>(count); ++j) {
                const Index index = j % 2 == 0 ? Index{2.35, 3e-3 * k} : Index{1.46, 1e-5 * k};
                film.layers.push_back(layer_of(550.0 / 4.0 / index.n, index));
            }
            add_together(films, count, draw, film, [&](FilmPoint& p) {
                p.cos_i = cosine(draw(0.0, 89.0));
                const double spread = draw(0.998, 1.002);
                for (FilmPoint::Layer& layer : p.layers)
                    layer.n = static_cast<float>(layer.n * spread);
            });
        }
    }
    return films;
}

std::vector<FilmInput> thick_stack_inputs(const Setting& setting) {
    FilmDraw draw(8);
    std::vector<FilmInput> films;
    for (const double count : counts_up_to_100()) {
        for (std::size_t i = 0; i < inputs(setting, 40, 3); ++i) {
            FilmPoint film;
            film.from_outside = draw.once_in(2);
            const auto incident = static_cast<float>(draw(4.0, 6.0)), rare = static_cast<float>(draw(1.0, 3.9));
            (film.from_outside ? film.n0 : film.base_n) = incident;
            (film.from_outside ? film.base_n : film.n0) = static_cast<float>(draw.once_in(2) ? rare : draw(1.0, 4.0));
            film.cos_i = cosine_of_sine(double{rare} / incident * (1.0 + (draw.once_in(2) ? 0.0 : draw(-1e-6, 1e-6))));
            const double thickest = draw.once_in(2) ? 1e6 : draw.logarithmic(1.0, 1e6);
            for (int j = 0; j < static_cast<int>(count); ++j) {
                const Index index = j % 2 == 0                      ? Index{rare, 0.0}
                                    : i % 3 == 2 && draw.once_in(3) ? absorbing_index(draw)
                                                                    : Index{draw(1.0, 4.0), 0.0};
                film.layers.push_back(layer_of(j % 2 == 0 ? thickest : draw(0.0, thickest), index));
            }
            add_together(films, count, draw, film, [](FilmPoint&) {});
        }
    }
    return films;
}

namespace {

/// Outside | guide | gap | base, light from the base: what the wave that grows towards the base has of amplitude under
/// the gap, up to a real factor, at a cosine in the base. Zero where the guide guides. Fields as in
/// kernels/thin_film.h.
double growing_wave(const FilmPoint& film, bool p_polarised, double cosine) {
    using Complex = std::complex<double>;
    const double n = film.base_n, beta2 = n * n * (1.0 - cosine) * (1.0 + cosine);
    const auto q = [&](double index) { return std::sqrt(Complex(index * index - beta2)); };
    const auto admittance = [&](double index) { return p_polarised ? index * index / q(index) : q(index); };
    const double guide_n = film.layers[0].n, gap_n = film.layers[1].n, n0 = film.n0;
    const Complex phase =
        2.0 * std::numbers::pi / film.lambda * q(guide_n) * static_cast<double>(film.layers[0].thickness);
    const Complex u = 1.0, v = admittance(n0), eta = admittance(guide_n), i(0.0, 1.0);
    const Complex u_above = std::cos(phase) * u - i * std::sin(phase) / eta * v;
    const Complex v_above = std::cos(phase) * v - i * eta * std::sin(phase) * u;
    return (v_above / admittance(gap_n) + u_above).real();
}

} // namespace

std::vector<FilmInput> guided_mode_inputs(const Setting& setting) {
    FilmDraw draw(9);
    std::vector<FilmInput> films;
    constexpr int ulps = 16;
    for (std::size_t i = 0; i < inputs(setting, 500, 4); ++i) {
        FilmPoint film;
        film.from_outside = false;
        film.n0 = static_cast<float>(draw(1.0, 1.4));
        film.base_n = 2.5F;
        film.layers = {layer_of(draw(150.0, 1500.0), {draw(1.9, 2.4), 0.0}),
                       layer_of(draw.logarithmic(1000.0, 1e5), {draw(1.0, 1.6), 0.0})};
        film.lambda = static_cast<float>(draw(380.0, 780.0));
        // Guided light is evanescent in both neighbours of the guide: β between their indices and its own.
        const double least = std::max(film.n0, film.layers[1].n) * 1.001, most = film.layers[0].n * 0.999;
        const bool p_polarised = draw.once_in(2);
        const auto cosine_at = [&](double beta) {
            const double sine = beta / film.base_n;
            return std::sqrt((1.0 - sine) * (1.0 + sine));
        };
        constexpr int steps = 200;
        double before = cosine_at(least), value_before = growing_wave(film, p_polarised, before);
        for (int j = 1; j <= steps; ++j) {
            double after = cosine_at(least + (most - least) * j / steps);
            const double value_after = growing_wave(film, p_polarised, after);
            if ((value_before < 0.0) != (value_after < 0.0)) {
                for (int bisection = 0; bisection < 60; ++bisection) {
                    const double middle = 0.5 * (before + after);
                    const bool left = (growing_wave(film, p_polarised, middle) < 0.0) != (value_before < 0.0);
                    (left ? after : before) = middle;
                }
                FilmPoint moved = film;
                moved.cos_i = static_cast<float>(after);
                for (int ulp = 0; ulp < ulps / 2; ++ulp)
                    moved.cos_i = std::nextafter(moved.cos_i, 0.0F);
                for (int ulp = -ulps / 2; ulp < ulps / 2; ++ulp) {
                    films.push_back({static_cast<double>(ulp), moved});
                    moved.cos_i = std::nextafter(moved.cos_i, 1.0F);
                }
                after = cosine_at(least + (most - least) * j / steps);
            }
            before = after;
            value_before = value_after;
        }
    }
    return films;
}

} // namespace tristim::selftest
