#pragma once

// Films, angles and error bounds that film_optics is tested with.

#include "kernel_harness.h"
#include "thin_film_kernel.h"

#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

namespace tristim::kernel_test {

/// Promised: absolute errors of each share, for films up to 2 µm thick in all and for all films.
constexpr double bound_up_to_2um = 5e-6;
constexpr double bound = 1e-4;

struct Index {
    double n, k;
};
inline const std::vector<Index> dielectrics{{1.0, 0.0}, {1.33, 0.0}, {1.5, 0.0}, {2.4, 0.0}};
// Silver, aluminium and titanium in the green, stronger and weaker absorbers.
inline const std::vector<Index> conductors{{0.06, 3.4}, {0.9, 6.4}, {2.2, 2.9}, {4.0, 9.0}, {1.5, 1e-4}};

inline const std::vector<double> thicknesses{0.0,   1e-3,   1.0,    10.0,     50.0,     100.0,
                                             300.0, 1000.0, 2000.0, 10'000.0, 100'000.0};
inline const std::vector<double> angles{0.0, 0.1, 10.0, 30.0, 45.0, 56.31, 60.0, 75.0, 85.0, 89.0, 89.9};

inline float cosine(double degrees) {
    return static_cast<float>(std::cos(degrees * std::numbers::pi / 180.0));
}

inline double total_thickness(const FilmCase& film) {
    return std::accumulate(film.thickness.begin(), film.thickness.end(), 0.0);
}

/// Films with slots spread over the wavelengths, ends included, and over indices by a relative `spread`.
class Cases {
  public:
    Cases(std::uint32_t seed, double spread, FilmProgram program = {})
        : random_(seed), spread_(spread), program_(program) {}

    void add(const std::string& what, double n0, const std::vector<oracle::Layer>& layers, Index base, float cos_i,
             bool from_outside) {
        FilmCase film{what, {}, from_outside, {}};
        for (const oracle::Layer& layer : layers)
            film.thickness.push_back(static_cast<float>(layer.thickness));
        for (std::size_t w = 0; w < film_slots(program_); ++w) {
            FilmSlot slot;
            slot.lambda = static_cast<float>(w == 0 ? 380.0 : w == 1 ? 780.0 : random_(380.0, 780.0));
            slot.n0 = static_cast<float>(n0);
            slot.base_n = spread(base.n);
            slot.base_k = spread(base.k);
            slot.cos_i = cos_i;
            for (const oracle::Layer& layer : layers) {
                slot.n.push_back(spread(layer.n));
                slot.k.push_back(spread(layer.k));
            }
            film.slots.push_back(slot);
        }
        list.push_back(film);
    }
    void add_both_ways(const std::string& what, double n0, const std::vector<oracle::Layer>& layers, Index base,
                       float cos_i) {
        add(what, n0, layers, base, cos_i, true);
        if (base.k == 0.0)
            add(what, n0, layers, base, cos_i, false);
    }

    double random(double low, double high) { return random_(low, high); }
    std::size_t below(std::size_t count) { return random_.bits() % count; }
    float random_cosine() { return cosine(random_(0.0, 89.9)); }
    const FilmProgram& program() const { return program_; }

    std::vector<FilmCase> list;

  private:
    float spread(double value) { return static_cast<float>(value * (1.0 + spread_ * random_(-1.0, 1.0))); }

    Random random_;
    double spread_;
    FilmProgram program_;
};

inline std::string describe(const oracle::FilmOptics& o) {
    return fmt::format("R_s {:.8f} R_p {:.8f} T_s {:.8f} T_p {:.8f}", o.reflected_s, o.reflected_p, o.transmitted_s,
                       o.transmitted_p);
}

/// Stacks of any layers, 1 to 40.
inline void add_random_stacks(Cases& cases, int count, double total, bool absorbing) {
    for (int i = 0; i < count; ++i) {
        const std::size_t layers = 1 + cases.below(40);
        std::vector<oracle::Layer> stack;
        double sum = 0.0;
        for (std::size_t j = 0; j < layers; ++j) {
            const bool absorbs = absorbing && cases.below(3) == 0;
            const Index index =
                absorbs ? conductors[cases.below(conductors.size())] : Index{cases.random(1.0, 3.0), 0.0};
            stack.push_back({cases.random(0.0, absorbs ? 0.1 : 1.0), index.n, index.k});
            sum += stack.back().thickness;
        }
        for (oracle::Layer& layer : stack)
            layer.thickness *= 0.999 * total / sum;
        const std::vector<Index>& bases = cases.below(2) == 0 ? dielectrics : conductors;
        cases.add_both_ways(fmt::format("stack {} of {} layers", i, layers), 1.0, stack,
                            bases[cases.below(bases.size())], cases.random_cosine());
    }
}

} // namespace tristim::kernel_test
