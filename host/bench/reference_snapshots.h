#pragma once

#include "render/film.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tristim {

/// Means of the same number of first passes of both halves of a reference.
using HalfFilms = std::array<FilmImage, 2>;

/// Means of the first passes, of which those are wanted that have about an eighth of all passes: few enough that their
/// blur is twice the image's (for α = 2/3), many enough that they are not all noise. How many passes there will be is
/// not known, so means are kept as the render goes, and forgotten once later ones serve better for ever.
class ReferenceSnapshots {
  public:
    static constexpr double wanted_share = 1.0 / 8.0;

    /// Adds means of more passes than those before.
    void add(HalfFilms films);

    /// The means that lie nearest to the wanted share of the passes of a half, in ratio; null if none has fewer.
    /// `passes` must not decrease from call to call.
    const HalfFilms* best(std::uint64_t passes);

  private:
    /// Those that serve no better than a later one from now on.
    void forget(std::uint64_t passes);

    std::vector<HalfFilms> films_; ///< by ascending passes
};

} // namespace tristim
