// What holds for film_optics of kernels/thin_film.h whatever the film: shares are shares, power is conserved, and
// transmittance is reciprocal.

#include "thin_film_cases.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

namespace tristim {
namespace {

using namespace kernel_test;
using oracle::FilmOptics;
using oracle::Layer;

/// Every extreme together: what comes out is a number, a share, and no more than came in.
TEST(KernelThinFilm, SharesAreNumbers) {
    const std::vector<Index> indices{{1e-3, 0.0},  {0.5, 0.0},  {1.0, 0.0}, {1.5, 0.0}, {4.0, 0.0},
                                     {0.01, 1e-6}, {0.06, 3.4}, {1.0, 1.0}, {2.0, 12.0}};
    for (const bool absorbing : {false, true}) {
        Cases cases(15, 0.0, {8, absorbing});
        for (const Index& layer : indices) {
            if (layer.k > 0.0 && !absorbing)
                continue;
            for (const Index& base : indices)
                for (const double thickness : thicknesses)
                    for (const float c : {0.0F, 1e-20F, 1e-12F, 1e-6F, 1e-3F, 0.5F, 0x1.fffffep-1F, 1.0F})
                        for (const std::size_t count : {0UL, 1UL, 2UL, 7UL, 40UL})
                            cases.add_both_ways(fmt::format("{}+{}i on {}+{}i", layer.n, layer.k, base.n, base.k), 1.0,
                                                std::vector<Layer>(count, {thickness, layer.n, layer.k}), base, c);
        }
        const std::vector<std::vector<FilmOptics>> results = evaluate_films(cases.program(), cases.list);
        for (std::size_t i = 0; i < results.size(); ++i)
            for (std::size_t w = 0; w < results[i].size(); ++w) {
                const FilmCase& film = cases.list[i];
                const FilmOptics& o = results[i][w];
                const double most = 1.0 + 2.0 * (total_thickness(film) <= 2000.0 ? bound_up_to_2um : bound);
                const bool possible = o.reflected_s >= 0.0 && o.reflected_p >= 0.0 && o.transmitted_s >= 0.0 &&
                                      o.transmitted_p >= 0.0 && o.reflected_s + o.transmitted_s <= most &&
                                      o.reflected_p + o.transmitted_p <= most;
                ASSERT_TRUE(possible) << film.what << ", thickness " << fmt::format("{}", film.thickness)
                                      << ", cos θ = " << film.slots[w].cos_i << ", λ = " << film.slots[w].lambda
                                      << (film.from_outside ? ", from outside: " : ", from the base: ") << describe(o);
            }
    }
}

/// Without absorption R + T = 1. The errors of R and T up to 2 µm add up to this at most, and an error of phase, which
/// is all that thickness adds, loses no power.
TEST(KernelThinFilm, LosslessFilmsConservePower) {
    for (const bool absorbing : {false, true}) {
        Cases cases(16, 0.01, {8, absorbing});
        for (const double total : {100.0, 2000.0, 100'000.0})
            add_random_stacks(cases, 40, total, false);
        for (const double thickness : thicknesses)
            for (const double angle : angles)
                for (const Index base : dielectrics)
                    cases.add_both_ways("one layer", 1.0, {{thickness, 1.38, 0.0}}, base, cosine(angle));
        std::erase_if(cases.list, [](const FilmCase& film) { return film.slots[0].base_k > 0.0F; });
        const std::vector<std::vector<FilmOptics>> results = evaluate_films(cases.program(), cases.list);
        double worst = 0.0;
        for (std::size_t i = 0; i < results.size(); ++i)
            for (const FilmOptics& o : results[i])
                for (const double sum : {o.reflected_s + o.transmitted_s, o.reflected_p + o.transmitted_p}) {
                    ASSERT_NEAR(sum, 1.0, 2.0 * bound_up_to_2um) << cases.list[i].what << ": " << describe(o);
                    worst = std::max(worst, std::abs(sum - 1.0));
                }
        RecordProperty(absorbing ? "worst_sum_if_absorbing" : "worst_sum", fmt::format("{:.2g}", worst));
    }
}

/// The same share passes in both directions along a path (Born & Wolf 1999, 1.6.4).
TEST(KernelThinFilm, TransmittanceIsReciprocal) {
    Cases down(17, 0.01, {8, false});
    add_random_stacks(down, 60, 2000.0, false);
    std::erase_if(down.list, [](const FilmCase& film) { return film.slots[0].base_k > 0.0F || !film.from_outside; });
    Cases up(18, 0.0, down.program());
    up.list = down.list;
    for (FilmCase& film : up.list) {
        film.from_outside = false;
        for (FilmSlot& slot : film.slots) {
            const double base = slot.base_n, c = slot.cos_i;
            slot.cos_i = static_cast<float>(std::sqrt(1.0 - (1.0 - c) * (1.0 + c) / (base * base)));
        }
    }
    const std::vector<std::vector<FilmOptics>> there = evaluate_films(down.program(), down.list);
    const std::vector<std::vector<FilmOptics>> back = evaluate_films(up.program(), up.list);
    for (std::size_t i = 0; i < there.size(); ++i)
        for (std::size_t w = 0; w < there[i].size(); ++w) {
            // Beside the promised errors, what the rounding of the refracted cosine does to the exact answer.
            const FilmOptics exact_there = expected_optics(down.list[i], down.list[i].slots[w]);
            const FilmOptics exact_back = expected_optics(up.list[i], up.list[i].slots[w]);
            ASSERT_NEAR(there[i][w].transmitted_s, back[i][w].transmitted_s,
                        2.0 * bound_up_to_2um + std::abs(exact_there.transmitted_s - exact_back.transmitted_s))
                << down.list[i].what;
            ASSERT_NEAR(there[i][w].transmitted_p, back[i][w].transmitted_p,
                        2.0 * bound_up_to_2um + std::abs(exact_there.transmitted_p - exact_back.transmitted_p))
                << down.list[i].what;
        }
}

} // namespace
} // namespace tristim
