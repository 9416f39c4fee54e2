#include "render/statistics.h"

#include <fmt/format.h>

#include <algorithm>

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

void add_work(RenderStatistics& statistics, const RenderStatistics& more) {
    statistics.bvh_seconds = std::max(statistics.bvh_seconds, more.bvh_seconds);
    statistics.build_kernels_seconds = std::max(statistics.build_kernels_seconds, more.build_kernels_seconds);
    statistics.pilot_seconds = std::max(statistics.pilot_seconds, more.pilot_seconds);
    statistics.render_seconds += more.render_seconds;
    for (std::size_t step = 0; step < step_names.size(); ++step)
        statistics.step_seconds[step] += more.step_seconds[step];
    statistics.passes += more.passes;
    statistics.photons_emitted += more.photons_emitted;
    statistics.photons_stored += more.photons_stored;
}

} // namespace tristim
