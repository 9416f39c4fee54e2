#pragma once

// The films that the cases of `tristim selftest` try: each varies one parameter over its whole range and draws the
// rest.

#include "selftest/film_points.h"

#include <cstdint>
#include <random>
#include <vector>

namespace tristim::selftest {

/// Random numbers that are the same everywhere.
class FilmDraw {
  public:
    explicit FilmDraw(std::uint32_t seed) : engine_(seed) {}
    double operator()(double low, double high) { return low + (high - low) * static_cast<double>(engine_()) * 0x1p-32; }
    double logarithmic(double low, double high);
    std::size_t below(std::size_t count) { return engine_() % count; }
    bool once_in(std::size_t count) { return below(count) == 0; }

  private:
    std::mt19937 engine_;
};

/// Values at equal ratios from low to high, `per_decade` of them, both ends included.
std::vector<double> logarithmic_steps(double low, double high, int per_decade);

/// Thickness in nm of a film of one layer, or of two of this thickness together.
std::vector<FilmInput> thickness_inputs(const Setting& setting, double low, double high);
/// Degrees that the angle lacks of 90, for films of 0 to 4 layers up to 2 µm.
std::vector<FilmInput> angle_inputs(const Setting& setting);
/// Relative distance of the angle's sine from that of total reflection, at the far side or in a layer.
std::vector<FilmInput> total_reflection_inputs(const Setting& setting);
/// Relative difference of the indices of a layer and of what lies above it, below it, or both.
std::vector<FilmInput> matched_inputs(const Setting& setting);
/// Imaginary part k of the index of a layer, the base or both.
std::vector<FilmInput> absorption_inputs(const Setting& setting, double low, double high);
/// Number of layers, of any indices, 2 µm in all.
std::vector<FilmInput> random_stack_inputs(const Setting& setting);
/// Number of quarter waves, alternately of a high and a low index.
std::vector<FilmInput> quarter_wave_inputs(const Setting& setting);
/// Number of layers up to 1 mm each, some at whose critical angle light comes: the fields grow most.
std::vector<FilmInput> thick_stack_inputs(const Setting& setting);
/// Ulps of the cosine from where a layer behind an opaque gap guides light.
std::vector<FilmInput> guided_mode_inputs(const Setting& setting);

} // namespace tristim::selftest
