#include "commands/bench_pass.h"

#include "base/error.h"
#include "base/median.h"
#include "base/stopwatch.h"
#include "bvh/ray_tracer.h"
#include "commands/device_options.h"
#include "commands/render_arguments.h"
#include "render/renderer.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>

namespace tristim {
namespace {

struct BenchPassCommand {
    RenderArguments arguments;
    std::string tuning;
    int repeats = 32;
    bool json = false;
};

/// The rays of one pass, apart by kind of query.
struct PassRays {
    std::vector<Ray> closest;
    std::vector<Ray> any;
};

PassRays record_pass(const Scene& scene, RenderOptions options, const Device& device, std::uint32_t pass) {
    options.record_rays = true;
    Renderer renderer(scene, options, device);
    renderer.render_pass(pass);
    PassRays rays;
    for (const Ray& ray : renderer.recorded_rays())
        (ray.unused != 0.0F ? rays.any : rays.closest).push_back(ray);
    return rays;
}

/// Medians in milliseconds.
struct Measured {
    double pass = 0.0;
    double rays_alone = 0.0;
    double ratio = 0.0; ///< of pass to rays alone, of the same repeat
    std::array<double, step_names.size()> steps{};
};

/// Times the first passes of a render, from 0 on, as they come: radii shrink from pass to pass.
Measured measure(Renderer& renderer, RayTracer& closest, RayTracer& any, int repeats) {
    std::vector<double> passes, alone, ratios;
    std::array<std::vector<double>, step_names.size()> steps;
    constexpr int warm_up = 2; // kernels are compiled for their work-group size when first launched
    for (int repeat = -warm_up; repeat < repeats; ++repeat) {
        const auto before = renderer.statistics().step_seconds;
        const Stopwatch of_pass;
        renderer.render_pass(static_cast<std::uint32_t>(std::max(repeat, 0)));
        const double pass_ms = 1e3 * of_pass.seconds();
        const Stopwatch of_rays;
        closest.run_closest();
        any.run_any();
        const double rays_ms = 1e3 * of_rays.seconds();
        if (repeat < 0)
            continue;
        passes.push_back(pass_ms);
        alone.push_back(rays_ms);
        ratios.push_back(pass_ms / rays_ms);
        for (std::size_t step = 0; step < steps.size(); ++step)
            steps[step].push_back(1e3 * (renderer.statistics().step_seconds[step] - before[step]));
    }
    Measured measured{median(passes), median(alone), median(ratios), {}};
    for (std::size_t step = 0; step < steps.size(); ++step)
        measured.steps[step] = median(steps[step]);
    return measured;
}

void run(const BenchPassCommand& command) {
    if (command.repeats < 1)
        fail("--repeats must be at least 1");
    const Scene scene = load_scene(command.arguments.scene, command.arguments.rgb_upsampling);
    const RenderOptions options = resolve_options(command.arguments, scene);
    const Device device = open_tuned_device(command.arguments.device, command.tuning);
    // The number of rays hardly changes between passes: those of the middle one serve for all.
    const PassRays rays = record_pass(scene, options, device, static_cast<std::uint32_t>(command.repeats / 2));
    Renderer renderer(scene, options, device);
    RayTracer closest(device, renderer.bvh(), {options.fast_math, ""});
    RayTracer any(device, renderer.bvh(), {options.fast_math, ""});
    closest.set_rays(rays.closest);
    any.set_rays(rays.any);
    const Measured measured = measure(renderer, closest, any, command.repeats);

    const std::uint64_t renders = renderer.statistics().passes;
    const RayTotals totals = renderer.rays();
    nlohmann::ordered_json json;
    json["device"] = device.info.name;
    json["tuning"] = to_string(device.tuning);
    json["pass_ms"] = measured.pass;
    json["rays_alone_ms"] = measured.rays_alone;
    json["ratio"] = measured.ratio;
    for (std::size_t step = 0; step < step_names.size(); ++step)
        json["steps_ms"][step_names[step]] = measured.steps[step];
    json["rays"] = {
        {"camera", totals.camera / renders}, {"shadow", totals.shadow / renders}, {"photon", totals.photon / renders}};
    json["bytes_per_pixel"] = renderer.statistics().bytes_per_pixel;
    json["bytes_per_photon"] = renderer.statistics().bytes_per_photon;
    if (command.json) {
        fmt::print("{}\n", json.dump(2));
        return;
    }
    fmt::print("{} with {} at {}x{}, {} photons, on {}: medians of {}\n", command.arguments.scene,
               options.method.name(), options.width, options.height, options.photons_per_pass, device.info.name,
               command.repeats);
    fmt::print("pass            {:8.2f} ms\n", measured.pass);
    for (std::size_t step = 0; step < step_names.size(); ++step)
        fmt::print("  {:<13} {:8.2f} ms\n", step_names[step], measured.steps[step]);
    fmt::print("its rays alone  {:8.2f} ms  ({} nearest-hit, {} shadow)\n", measured.rays_alone, rays.closest.size(),
               rays.any.size());
    fmt::print("ratio           {:8.2f}\n", measured.ratio);
    fmt::print("memory          {:.0f} bytes a pixel, {:.0f} bytes a photon\n", renderer.statistics().bytes_per_pixel,
               renderer.statistics().bytes_per_photon);
}

} // namespace

void add_bench_pass_command(CLI::App& app) {
    auto command = std::make_shared<BenchPassCommand>();
    CLI::App* sub = app.add_subcommand("bench-pass", "Time a pass by step, beside its rays alone");
    add_render_arguments(*sub, command->arguments);
    add_tuning_option(*sub, command->tuning);
    sub->add_option("--repeats", command->repeats, "Passes to time, from the first on; medians count")
        ->capture_default_str();
    sub->add_flag("--json", command->json, "Print JSON");
    sub->callback([command] { run(*command); });
}

} // namespace tristim
