#include "render/statistics.h"

#include <fmt/format.h>

namespace tristim {

NonFiniteCounts non_finite_counts(const std::vector<std::uint32_t>& counted, const std::vector<FilmPixel>& film) {
    const auto count_at = [&](std::size_t kind) {
        return std::uint64_t{counted[2 * kind]} | std::uint64_t{counted[2 * kind + 1]} << 32U;
    };
    NonFiniteCounts found{count_at(NON_FINITE_EYE), count_at(NON_FINITE_PHOTON), count_at(NON_FINITE_GATHER), 0};
    for (const FilmPixel& pixel : film)
        found.film += pixel.rejected;
    return found;
}

std::string describe(const NonFiniteCounts& counts) {
    return fmt::format("eye {}, photon {}, gather {}, film {}", counts.eye, counts.photon, counts.gather, counts.film);
}

} // namespace tristim
