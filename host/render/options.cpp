#include "render/options.h"

#include "base/error.h"

#include <cmath>

namespace tristim {

RenderOptions options_from_scene(const RenderSettings& settings) {
    RenderOptions options;
    options.width = settings.width;
    options.height = settings.height;
    options.region = {0, 0, settings.width, settings.height};
    options.photons_per_pass = settings.photons_per_pass.value_or(default_photons_per_pass);
    options.max_depth = settings.max_depth.value_or(default_max_depth);
    options.radius = settings.initial_radius;
    options.seed = settings.seed.value_or(0);
    return options;
}

std::string method_name(const RenderOptions& options) {
    return options.auto_method ? "auto" : options.method.name();
}

std::string sequence_name(const RenderOptions& options) {
    return options.random_sequence ? "random" : "stratified";
}

void check_options(const RenderOptions& options) {
    constexpr int largest_side = 1 << 15;
    constexpr int most_photons = 1 << 27;
    constexpr int deepest = 1 << 12;
    if (options.width < 1 || options.height < 1 || options.width > largest_side || options.height > largest_side)
        fail("resolution {}x{} is not between 1x1 and {}x{}", options.width, options.height, largest_side,
             largest_side);
    const Region& r = options.region;
    if (!contains({0, 0, options.width, options.height}, r) || r.pixels() < 1)
        fail("region {},{},{},{} is empty or not inside the {}x{} image", r.x, r.y, r.x + r.width, r.y + r.height,
             options.width, options.height);
    if (options.photons_per_pass < 1 || options.photons_per_pass > most_photons)
        fail("{} photons per pass is not between 1 and {}", options.photons_per_pass, most_photons);
    if (options.max_depth < 1 || options.max_depth > deepest)
        fail("maximum depth {} is not between 1 and {}", options.max_depth, deepest);
    if (options.radius && !(*options.radius > 0.0))
        fail("search radius {} is not positive", *options.radius);
    if (!(options.radius_factor > 0.0 && std::isfinite(options.radius_factor)))
        fail("radius factor {} is not a positive number", options.radius_factor);
    if (!(options.alpha > 0.0 && options.alpha < 1.0))
        fail("alpha {} is not between 0 and 1", options.alpha);
    if (!(options.photon_roughness >= 0.0))
        fail("photon roughness {} is not a number from 0 on", options.photon_roughness);
}

} // namespace tristim
