#pragma once

// film_optics of kernels/thin_film.h on the test device, for any films.

#include "selftest/film_oracle.h"

#include <string>
#include <vector>

namespace tristim::kernel_test {

/// What a wavelength slot of a path sees of a film. A slot's place in its vector must not matter, so each has indices
/// of its own.
struct FilmSlot {
    float lambda = 550.0F;
    float n0 = 1.0F;
    float base_n = 1.5F, base_k = 0.0F;
    float cos_i = 1.0F;
    std::vector<float> n, k; ///< of each layer
};

/// One call of film_optics for each block of slots. `slots` holds as many as film_slots says.
struct FilmCase {
    std::string what;
    std::vector<float> thickness;
    bool from_outside = true;
    std::vector<FilmSlot> slots;
};

/// How the kernel is compiled: macros LANES and HAS_ABSORBING_FILM. Paths carry two blocks.
struct FilmProgram {
    int lanes = 8;
    bool absorbing = true;
};

std::size_t film_slots(const FilmProgram& program);

/// What the kernel answers, for each case and slot. What the kernel should not read is NaN: the thickness of the first
/// layer but in ThinFilm::first_thickness, the rows of weights, and the layers' k without HAS_ABSORBING_FILM.
std::vector<std::vector<oracle::FilmOptics>> evaluate_films(const FilmProgram& program,
                                                            const std::vector<FilmCase>& cases);

/// The oracle's answer to the same.
oracle::FilmOptics expected_optics(const FilmCase& film, const FilmSlot& slot);

} // namespace tristim::kernel_test
