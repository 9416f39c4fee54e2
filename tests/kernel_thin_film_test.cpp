// film_optics of kernels/thin_film.h against the oracle in extended precision, both given the same floats.

#include "thin_film_cases.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>
#include <limits>

namespace tristim {
namespace {

using namespace kernel_test;
using oracle::FilmOptics;
using oracle::Layer;

/// The largest of the four; infinite if one is no number.
double difference(const FilmOptics& a, const FilmOptics& b) {
    double worst = 0.0;
    for (const double d : {a.reflected_s - b.reflected_s, a.reflected_p - b.reflected_p,
                           a.transmitted_s - b.transmitted_s, a.transmitted_p - b.transmitted_p})
        worst = std::max(worst, std::isnan(d) ? std::numeric_limits<double>::infinity() : std::abs(d));
    return worst;
}

/// How far the exact answer moves when one input moves by its relative rounding error: what to blame a miss on.
double sensitivity(const FilmCase& film, const FilmSlot& slot) {
    const FilmOptics exact = expected_optics(film, slot);
    double worst = 0.0;
    const auto move = [&](const FilmCase& moved_film, const FilmSlot& moved_slot, float& value) {
        const float kept = value;
        for (const double sign : {-1.0, 1.0}) {
            // The oracle takes doubles, but films are in floats: one ulp, which is one to two units of roundoff.
            value = std::nextafter(kept, sign > 0.0 ? std::numeric_limits<float>::infinity() : 0.0F);
            if (&value == &moved_slot.cos_i)
                value = std::min(value, 1.0F);
            worst = std::max(worst, difference(exact, expected_optics(moved_film, moved_slot)));
        }
        value = kept;
    };
    FilmCase f = film;
    FilmSlot s = slot;
    for (float& thickness : f.thickness)
        move(f, s, thickness);
    for (float* value : {&s.cos_i, &s.lambda, &s.n0, &s.base_n, &s.base_k})
        move(f, s, *value);
    for (float& n : s.n)
        move(f, s, n);
    for (float& k : s.k)
        move(f, s, k);
    return worst;
}

struct Worst {
    double error = 0.0;
    std::string where;
};

/// Kernel against oracle, within the promised bounds. `name` tells apart what one test checks. Where an ulp of one
/// input moves the exact answer by more than the bound and by more than the kernel is off (long absorbing stacks near
/// grazing), no calculation with these floats means more: such cases are counted apart, and may be one in a hundred.
void check(const Cases& cases, const std::string& name = {}) {
    const std::vector<std::vector<FilmOptics>> results = evaluate_films(cases.program(), cases.list);
    Worst thin, all;
    std::size_t shares = 0, ill_conditioned = 0;
    for (std::size_t i = 0; i < cases.list.size(); ++i) {
        const FilmCase& film = cases.list[i];
        Worst& worst = total_thickness(film) <= 2000.0 ? thin : all;
        for (std::size_t w = 0; w < film.slots.size(); ++w) {
            const FilmSlot& slot = film.slots[w];
            const FilmOptics exact = expected_optics(film, slot);
            const double error = difference(results[i][w], exact);
            ++shares;
            if (error <= worst.error)
                continue;
            const double promised = &worst == &thin ? bound_up_to_2um : bound;
            if (error > promised && error <= sensitivity(film, slot)) {
                ++ill_conditioned;
                continue;
            }
            worst = {error, {}};
            if (error <= promised)
                continue;
            worst.where =
                fmt::format("{}, {}, cos θ = {:.9g}, slot {}, λ = {:.9g}, n0 = {:.9g}, thickness {}, n {}, k {}, base "
                            "{:.9g} + {:.9g}i\n  kernel {}\n  oracle {}\n  an ulp of one input moves the exact answer "
                            "by {:.2g}",
                            film.what, film.from_outside ? "from outside" : "from the base", slot.cos_i, w, slot.lambda,
                            slot.n0, film.thickness, slot.n, slot.k, slot.base_n, slot.base_k, describe(results[i][w]),
                            describe(exact), sensitivity(film, slot));
        }
    }
    testing::Test::RecordProperty("worst_error_up_to_2um" + name, fmt::format("{:.2g}", thin.error));
    testing::Test::RecordProperty("worst_error_of_thicker" + name, fmt::format("{:.2g}", all.error));
    testing::Test::RecordProperty("ill_conditioned" + name, std::to_string(ill_conditioned));
    EXPECT_LE(ill_conditioned, shares / 100);
    EXPECT_LE(thin.error, bound_up_to_2um) << "up to 2 µm: " << thin.where;
    EXPECT_LE(all.error, bound) << "beyond 2 µm: " << all.where;
}

/// One layer of each index on each base, over all thicknesses and angles and some random ones.
void add_single_layers(Cases& cases, const std::vector<Index>& layers, const std::vector<Index>& bases) {
    for (const Index& layer : layers)
        for (const Index& base : bases) {
            const std::string what = fmt::format("{}+{}i on {}+{}i", layer.n, layer.k, base.n, base.k);
            for (const double thickness : thicknesses)
                for (const double angle : angles)
                    cases.add_both_ways(what, 1.0, {{thickness, layer.n, layer.k}}, base, cosine(angle));
            for (int i = 0; i < 100; ++i) {
                const double thickness = i % 2 == 0 ? cases.random(0.0, 2000.0) : cases.random(0.0, 100'000.0);
                cases.add_both_ways(what, 1.0, {{thickness, layer.n, layer.k}}, base, cases.random_cosine());
            }
        }
}

TEST(KernelThinFilm, BareInterface) {
    Cases cases(1, 0.01);
    for (const std::vector<Index>& bases : {dielectrics, conductors})
        for (const Index& base : bases)
            for (const double angle : angles)
                cases.add_both_ways("bare", 1.0, {}, base, cosine(angle));
    check(cases);
}

TEST(KernelThinFilm, DielectricLayerOnDielectric) {
    Cases cases(2, 0.01, {8, false}), matched(3, 0.0, {8, true});
    add_single_layers(cases, {{1.0, 0.0}, {1.38, 0.0}, {1.5, 0.0}, {2.35, 0.0}, {4.0, 0.0}}, dielectrics);
    add_single_layers(matched, {{1.0, 0.0}, {1.33, 0.0}, {1.5, 0.0}, {2.4, 0.0}}, dielectrics);
    check(cases);
    check(matched, "_matched");
}

TEST(KernelThinFilm, DielectricLayerOnConductor) {
    Cases cases(4, 0.01, {8, false});
    add_single_layers(cases, {{1.0, 0.0}, {1.46, 0.0}, {2.5, 0.0}, {0.8, 0.0}}, conductors);
    check(cases);
}

TEST(KernelThinFilm, AbsorbingLayer) {
    Cases on_dielectric(5, 0.01), on_conductor(6, 0.01), matched(7, 0.0);
    add_single_layers(on_dielectric, conductors, dielectrics);
    add_single_layers(on_conductor, {{0.06, 3.4}, {2.5, 0.1}, {1.5, 1e-6}}, conductors);
    add_single_layers(matched, conductors, conductors);
    check(on_dielectric, "_on_dielectric");
    check(on_conductor, "_on_conductor");
    check(matched, "_matched");
}

/// Steps about an angle whose sine is known: in cosine and in sine.
std::vector<float> cosines_about(double sine) {
    const double middle = std::sqrt(1.0 - sine * sine);
    std::vector<float> list;
    for (const double step : {0.0, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2})
        for (const double sign : {-1.0, 1.0}) {
            list.push_back(static_cast<float>(std::clamp(middle + sign * step, 0.0, 1.0)));
            const double moved = std::clamp(sine + sign * step, 0.0, 1.0);
            list.push_back(static_cast<float>(std::sqrt(1.0 - moved * moved)));
        }
    return list;
}

/// Where a layer, or what lies beyond, begins to reflect totally; floats on either side of the limit.
TEST(KernelThinFilm, CriticalAngles) {
    Cases cases(8, 0.0);
    for (const double thickness : thicknesses) {
        for (const double layer : {1.2, 1.33, 1.38, 2.35})
            for (const double sine : {1.0 / 1.52, layer / 1.52}) // from glass: of the outside and of the layer
                for (const float c : cosines_about(std::min(sine, 1.0)))
                    cases.add("glass to air", 1.0, {{thickness, layer, 0.0}}, {1.52, 0.0}, c, false);
        for (const Index base : {Index{1.52, 0.0}, Index{1.0, 0.0}, Index{1.2, 0.0}, Index{0.06, 3.4}})
            for (const double sine : {1.0 / 1.52, 1.2 / 1.52}) // of a gap and of a base under glass
                for (const float c : cosines_about(sine)) {
                    cases.add("gap", 1.52, {{thickness, 1.0, 0.0}}, base, c, true);
                    cases.add("absorbing gap", 1.52, {{thickness, 1.0, 1e-4}}, base, c, true);
                }
        for (const float c : cosines_about(0.9)) // of a layer below the outside's index
            cases.add_both_ways("layer below 1", 1.0, {{thickness, 0.9, 0.0}}, {1.5, 0.0}, c);
    }
    check(cases);
}

TEST(KernelThinFilm, FrustratedTotalReflection) {
    Cases cases(9, 0.005);
    for (const double thickness : thicknesses)
        for (const double angle : {40.0, 41.5, 42.0, 45.0, 60.0, 80.0, 89.0, 89.9})
            for (const Index base : {Index{1.5, 0.0}, Index{1.8, 0.0}, Index{0.06, 3.4}}) {
                cases.add_both_ways("gap", 1.5, {{thickness, 1.0, 0.0}}, base, cosine(angle));
                cases.add_both_ways("gap between layers", 1.5,
                                    {{80.0, 2.35, 0.0}, {thickness, 1.0, 0.0}, {120.0, 1.38, 0.0}}, base,
                                    cosine(angle));
            }
    check(cases);
}

TEST(KernelThinFilm, BraggMirrors) {
    Cases lossless(10, 0.002, {8, false}), absorbing(11, 0.002);
    for (const std::size_t layers : {1UL, 2UL, 3UL, 6UL, 12UL, 20UL, 40UL}) {
        for (const double angle : {0.0, 20.0, 45.0, 70.0, 89.0})
            for (const Index base : {Index{1.52, 0.0}, Index{0.9, 6.4}}) {
                std::vector<Layer> clear, lossy;
                for (std::size_t i = 0; i < layers; ++i) {
                    const double n = i % 2 == 0 ? 2.35 : 1.46;
                    clear.push_back({550.0 / 4.0 / n, n, 0.0});
                    lossy.push_back({550.0 / 4.0 / n, n, i % 2 == 0 ? 3e-3 : 1e-5});
                }
                const std::string what = fmt::format("{} quarter waves", layers);
                lossless.add_both_ways(what, 1.0, clear, base, cosine(angle));
                absorbing.add_both_ways(what, 1.0, lossy, base, cosine(angle));
            }
    }
    check(lossless, "_lossless");
    check(absorbing, "_absorbing");
}

TEST(KernelThinFilm, RandomStacks) {
    Cases lossless(12, 0.01, {8, false}), absorbing(13, 0.01);
    for (const double total : {100.0, 500.0, 2000.0, 10'000.0, 100'000.0}) {
        add_random_stacks(lossless, 50, total, false);
        add_random_stacks(absorbing, 50, total, true);
    }
    check(lossless, "_lossless");
    check(absorbing, "_absorbing");
}

/// Under an opaque layer lies what does not matter, even where the layer's lower face is near a resonance and the wave
/// that prevails farther up is hardly excited there.
TEST(KernelThinFilm, OpaqueLayers) {
    Cases cases(20, 0.005), lossless(21, 0.005, {8, false});
    for (int i = 0; i < 400; ++i) {
        const float c = cosine(cases.random(0.0, 89.9));
        const double thickness = cases.random(600.0, 2000.0);
        for (const Index metal : {Index{0.06, 3.4}, Index{0.9, 6.4}}) {
            cases.add("metal under glass", 1.0, {{thickness, metal.n, metal.k}}, {1.33, 0.0}, c, false);
            cases.add("coated metal", 1.0, {{cases.random(0.0, 300.0), 1.5, 0.0}, {thickness, metal.n, metal.k}},
                      {1.5, 0.0}, c, false);
        }
        // A waveguide between evanescent waves.
        const std::vector<Layer> guide{
            {3000.0, 1.46, 0.0}, {cases.random(100.0, 1500.0), 2.38, 0.0}, {cases.random(1000.0, 3000.0), 1.6, 0.0}};
        const float beyond = cosine(cases.random(40.0, 89.9));
        cases.add("waveguide", 1.0, guide, {2.41, 0.0}, beyond, false);
        lossless.add("waveguide", 1.0, guide, {2.41, 0.0}, beyond, false);
        lossless.add("waveguide on metal", 2.41, guide, {0.06, 3.4}, beyond, true);
    }
    check(cases, "_absorbing");
    check(lossless, "_lossless");
}

/// Each way to compile the kernel, and slots that differ in everything but thickness.
TEST(KernelThinFilm, LanesAndMacros) {
    for (const int lanes : {4, 8, 16})
        for (const bool absorbing : {false, true}) {
            Cases cases(14, 0.05, {lanes, absorbing});
            cases.add_both_ways("bare", 1.0, {}, {1.5, 0.0}, cosine(70.0));
            for (const double thickness : {0.0, 120.0, 1500.0}) {
                const double k = absorbing ? 0.2 : 0.0;
                for (const Index base : {Index{1.5, 0.0}, Index{0.06, 3.4}}) {
                    cases.add_both_ways("one", 1.0, {{thickness, 1.38, k}}, base, cosine(35.0));
                    cases.add_both_ways("three", 1.0, {{thickness, 1.38, 0.0}, {70.0, 2.35, k}, {200.0, 1.6, 0.0}},
                                        base, cosine(50.0));
                }
            }
            for (FilmCase& film : cases.list)
                for (FilmSlot& slot : film.slots)
                    slot.cos_i = cases.random_cosine();
            check(cases, fmt::format("_{}_lanes{}", lanes, absorbing ? "_absorbing" : ""));
        }
}

} // namespace
} // namespace tristim
