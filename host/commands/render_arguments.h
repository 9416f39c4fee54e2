#pragma once

#include "render/options.h"

#include <CLI/CLI.hpp>

#include <optional>
#include <string>

namespace tristim {

/// The options of `render` that say what is rendered, shared by the commands that render.
struct RenderArguments {
    std::string scene;
    std::string method = "tristimulus:1";
    bool accepts_auto = false; ///< whether --method may be auto
    std::string sequence = "stratified";
    std::string resolution;
    std::string region;
    std::string direct = "sample";
    std::string radius = "global";
    std::string initial_radius;
    double radius_factor = 1.0;
    double alpha = radius_alpha;
    double photon_roughness = default_photon_roughness;
    std::string math = "precise";
    std::string device;
    std::string effects;
    std::string kernels;
    std::string dump_kernels;
    std::optional<int> photons;
    std::optional<int> max_depth;
    std::optional<std::uint32_t> seed;
    std::optional<RgbUpsampling> rgb_upsampling;
};

/// Registers SCENE, --method and the options.
void add_render_arguments(CLI::App& command, RenderArguments& arguments);

/// Registers only the options that commands with other scenes, methods and devices share.
void add_render_settings(CLI::App& command, RenderArguments& arguments);

/// What the arguments and the scene say together. Throws Error for values that make no sense.
RenderOptions resolve_options(const RenderArguments& arguments, const Scene& scene);

/// The scene's notes (Scene::notes) on stderr.
void print_notes(const Scene& scene);

} // namespace tristim
