#pragma once

#include "render/effects.h"
#include "render/flat_scene.h"
#include "render/method.h"
#include "render/radius_schedule.h"
#include "scene/scene.h"

#include <cstdint>
#include <optional>
#include <string>

namespace tristim {

/// How a scene is rendered; the scene's own settings fill what the user leaves open (resolve_options).
struct RenderOptions {
    Method method;
    bool auto_method = false;     ///< the method is still to be chosen (render/choose_method.h)
    bool random_sequence = false; ///< the paper's plain random wavelengths instead of the stratified sequence
    int width = 0;
    int height = 0;
    Region region;
    int photons_per_pass = 0;     ///< photon paths
    int max_depth = 0;            ///< vertices of a path
    std::optional<double> radius; ///< initial search radius, scene units; none: a pilot pass measures it per pixel
    double radius_factor = 1.0;   ///< on the initial radius, given or measured
    double alpha = radius_alpha;  ///< share of new photons kept as the radius shrinks
    std::uint32_t seed = 0;
    bool direct_photons = false;    ///< photons count from their first hit, direct light is not sampled
    bool statistics_radius = false; ///< Hachisuka et al. 2008's statistics of each pixel
    double photon_roughness = default_photon_roughness; ///< α from which on rough surfaces take photons
    Effects more_effects; ///< compiled in beside those that the scene calls for; they change nothing but the cost
    bool error_estimate = false; ///< keep what noise and bias are estimated from (render/error_estimate.h)
    bool fast_math = false;
    std::string kernels;      ///< folder to read kernel sources from instead of the binary's own, or empty
    std::string dump_kernels; ///< folder for the programs as built, or empty
    bool record_rays = false; ///< keep every ray of the last pass, for bench-pass
};

/// How long a render is to be: the limit that is reached first ends it.
struct RenderBudget {
    std::optional<std::uint64_t> passes; ///< from first_pass on
    std::optional<double> seconds;
    std::uint32_t first_pass = 0;
};

inline constexpr int default_photons_per_pass = 65536;
inline constexpr int default_max_depth = 16;

/// Options with the scene's own resolution, photons, depth, radius and seed.
RenderOptions options_from_scene(const RenderSettings& settings);

/// The method's name, or "auto".
std::string method_name(const RenderOptions& options);

/// The wavelength sequence as --sequence takes it: "random" or "stratified".
std::string sequence_name(const RenderOptions& options);

/// Throws Error for sizes, counts or a region that cannot be rendered.
void check_options(const RenderOptions& options);

} // namespace tristim
