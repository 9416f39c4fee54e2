#include "commands/render_arguments.h"

#include "base/error.h"
#include "base/region.h"
#include "base/tell.h"
#include "commands/device_options.h"
#include "commands/parse.h"
#include "spectra/rgb_upsampling.h"

#include <cmath>
#include <cstdlib>

namespace tristim {
namespace {

/// A positive number, or none for "auto".
std::optional<double> parse_initial_radius(const std::string& text) {
    if (text == "auto")
        return std::nullopt;
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (end == text.c_str() || *end != '\0' || !std::isfinite(value) || !(value > 0.0))
        fail("bad initial radius '{}': expected a positive number of scene units, or auto", text);
    return value;
}

} // namespace

void add_render_arguments(CLI::App& command, RenderArguments& a) {
    command.add_option("scene", a.scene, "Scene file (pbrt-v4 syntax)")->required()->type_name("SCENE");
    command
        .add_option("--method", a.method,
                    a.accepts_auto ? "How wavelengths are chosen, see `tristim methods`; auto finds out by trying"
                                   : "How wavelengths are chosen, see `tristim methods`")
        ->capture_default_str();
    add_render_settings(command, a);
    add_device_option(command, a.device);
    command
        .add_option("--effects", a.effects,
                    "Compile these effects in beside those that the scene calls for, or all; the image stays the same, "
                    "see `tristim effects`")
        ->type_name("NAME,...|all");
    command.add_option("--dump-kernels", a.dump_kernels, "Write the OpenCL programs as built, options included")
        ->type_name("DIR");
    command
        .add_option("--kernels", a.kernels,
                    "Read OpenCL sources from here, a changed copy of kernels/ or what --dump-kernels wrote")
        ->type_name("DIR");
}

void add_render_settings(CLI::App& command, RenderArguments& a) {
    command.add_option("--sequence", a.sequence, "Wavelength sequence: stratified, or random as in the paper")
        ->check(CLI::IsMember({"stratified", "random"}))
        ->capture_default_str();
    command.add_option("--photons", a.photons, "Photon paths per pass [scene, else 65536]")->type_name("PER_PASS");
    command.add_option("--resolution", a.resolution, "Image size in pixels, or as a share of the scene's [scene]")
        ->type_name("WxH|P%");
    command.add_option("--region", a.region, "Render only pixels X0 <= x < X1, Y0 <= y < Y1 [all]")
        ->type_name("X0,Y0,X1,Y1");
    command.add_option("--seed", a.seed, "Seed of all random numbers [scene, else 0]");
    command.add_option("--direct", a.direct, "Direct light: sample lights, or leave it to the photons")
        ->check(CLI::IsMember({"sample", "photons"}))
        ->capture_default_str();
    command
        .add_option("--radius", a.radius,
                    "Search radius: one global schedule (Knaus & Zwicker 2011), or per-pixel statistics (Hachisuka et "
                    "al. 2008)")
        ->check(CLI::IsMember({"global", "statistics"}))
        ->capture_default_str();
    command
        .add_option("--initial-radius", a.initial_radius,
                    "First search radius in scene units, or auto [scene, else auto]")
        ->type_name("R|auto");
    command.add_option("--radius-factor", a.radius_factor, "Factor on the first search radius, given or measured")
        ->type_name("F")
        ->capture_default_str();
    command
        .add_option("--alpha", a.alpha,
                    "Share of new photons kept as the search radius shrinks, in (0, 1): less shrinks it faster")
        ->capture_default_str();
    command.add_option("--max-depth", a.max_depth, "Vertices after which a path ends [scene, else 16]");
    command
        .add_option("--photon-roughness", a.photon_roughness,
                    "GGX roughness (alpha) from which on surfaces take photons; camera paths go on at smoother ones. "
                    "Glass of an index below 1.5 counts as smoother")
        ->type_name("ALPHA")
        ->capture_default_str();
    command
        .add_option_function<std::string>(
            "--rgb-upsampling", [&a](const std::string& name) { a.rgb_upsampling = parse_rgb_upsampling(name); },
            "Spectra of RGB colours: jakob-hanika (2019), or meng (2015) [scene, else jakob-hanika]")
        ->check(CLI::IsMember(rgb_upsampling_names()));
    add_math_option(command, a.math);
}

RenderOptions resolve_options(const RenderArguments& a, const Scene& scene) {
    RenderOptions options = options_from_scene(scene.settings);
    options.auto_method = a.method == "auto";
    if (options.auto_method && !a.accepts_auto)
        fail("--method auto is for render and bench: name a method here");
    if (!options.auto_method)
        options.method = parse_method(a.method);
    options.random_sequence = a.sequence == "random";
    if (!a.resolution.empty()) {
        const auto [width, height] = parse_resolution(a.resolution, {options.width, options.height});
        options.width = width;
        options.height = height;
        options.region = {0, 0, width, height};
    }
    if (!a.region.empty())
        options.region = parse_region(a.region);
    if (a.photons)
        options.photons_per_pass = *a.photons;
    if (a.max_depth)
        options.max_depth = *a.max_depth;
    if (a.seed)
        options.seed = *a.seed;
    if (!a.initial_radius.empty())
        options.radius = parse_initial_radius(a.initial_radius);
    options.direct_photons = a.direct == "photons";
    options.statistics_radius = a.radius == "statistics";
    options.radius_factor = a.radius_factor;
    options.alpha = a.alpha;
    options.photon_roughness = a.photon_roughness;
    if (!a.effects.empty())
        options.more_effects = parse_effects(a.effects);
    options.fast_math = a.math == "fast";
    options.kernels = a.kernels;
    options.dump_kernels = a.dump_kernels;
    check_options(options);
    return options;
}

void print_notes(const Scene& scene) {
    for (const std::string& note : scene.notes)
        tell("note: {}\n", note);
}

} // namespace tristim
