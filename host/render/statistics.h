#pragma once

#include "shared_types.h"

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tristim {

/// The steps of a pass, in order; names as in --stats.
enum class Step { Wavelengths, EyePass, PhotonPass, Grid, Gather, Film };
inline constexpr std::array<const char*, 6> step_names{"wavelengths", "eye", "photon", "grid", "gather", "film"};

/// Rays traced, by kind.
struct RayTotals {
    std::uint64_t camera = 0;
    std::uint64_t shadow = 0;
    std::uint64_t photon = 0;
};

/// Values that were not finite and so were left out, by the kernel that met them: contributions and visible points of
/// camera paths, photons and their paths, contributions of photons to a visible point, and samples of a pixel.
struct NonFiniteCounts {
    std::uint64_t eye = 0;
    std::uint64_t photon = 0;
    std::uint64_t gather = 0;
    std::uint64_t film = 0;

    std::uint64_t total() const { return eye + photon + gather + film; }
};

/// From the buffer in which the kernels count (low and high half of each count) and the pixels' own counts.
NonFiniteCounts non_finite_counts(const std::vector<std::uint32_t>& counted, const std::vector<FilmPixel>& film);

/// "eye 1, photon 0, gather 0, film 0".
std::string describe(const NonFiniteCounts& counts);

/// What a render has cost so far.
struct RenderStatistics {
    double bvh_seconds = 0.0;
    double build_kernels_seconds = 0.0; ///< building programs, and what drivers compile at first launches
    double pilot_seconds = 0.0;         ///< the pilot pass: its kernels on the device, and measuring radii
    double render_seconds = 0.0;        ///< passes, wall clock
    std::array<double, step_names.size()> step_seconds{}; ///< on the device
    std::uint64_t passes = 0;
    std::uint64_t photons_emitted = 0;
    std::uint64_t photons_stored = 0;
    std::vector<std::pair<std::string, std::uint64_t>> buffer_bytes;
    std::uint64_t pixel_bytes = 0;  ///< of buffers that grow with the pixels
    std::uint64_t photon_bytes = 0; ///< of buffers that grow with the photons: photon map and grid
    double bytes_per_pixel = 0.0;
    double bytes_per_photon = 0.0; ///< photon, its spectral fluxes and its sort keys
};

/// Adds what another device has done at the same time: of the times before the first pass the longer one counts, and
/// buffers stay those of the first.
void add_work(RenderStatistics& statistics, const RenderStatistics& more);

} // namespace tristim
