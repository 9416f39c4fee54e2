#include "commands/bench_wavelengths.h"

#include "base/error.h"
#include "bench/variants.h"
#include "bench/wavelength_error.h"
#include "commands/device_options.h"
#include "commands/progress_bar.h"
#include "commands/render_arguments.h"
#include "plot/plot.h"
#include "plot/wavelength_plot.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

namespace tristim {
namespace {

constexpr const char* baseline = "tristimulus:1@random"; // the paper's method with its sequence
constexpr std::uint64_t geometry_passes = 64;
constexpr int most_passes = 1 << 24, most_repeats = 1000;

struct BenchWavelengths {
    std::vector<std::string> scenes;
    std::string methods = "tristimulus:20@random,tristimulus:1,illuminant:1,illuminant-mixture:4,illuminant-mixture:8,"
                          "hero:4,gauss:4,visible:4,mixture:4";
    int passes = 2048;
    int repeats = 16;
    std::uint32_t seed = 0;
    std::string device;
    std::string plot;
    bool json = false;
    bool quiet = false;
};

/// The baseline, then the methods asked for.
VariantGroup variants(const BenchWavelengths& command, const RenderOptions& base) {
    std::string methods = baseline;
    for (const Variant& variant : method_variants(command.methods, base).variants) {
        if (variant.options.auto_method)
            fail("--methods takes no auto here: there is no noise of paths to weigh wavelengths against");
        const std::string name = method_name(variant.options) + "@" + sequence_name(variant.options);
        if (name != baseline)
            methods += "," + name;
    }
    return method_variants(methods, base);
}

/// What is measured of one scene.
struct MeasuredVariants {
    std::string scene;
    std::vector<Variant> variants;
    ExactImage exact;
    double geometric_noise = 0.0;
    std::vector<WavelengthCurve> curves; ///< of the variants

    /// How many times smaller the error of variant i is at the end than that of the baseline.
    double gain(std::size_t i) const { return curves.front().rmse.back() / curves[i].rmse.back(); }

    /// Standard error of that, from those of both.
    double gain_error(std::size_t i) const {
        if (i == 0)
            return 0.0;
        return gain(i) * std::hypot(curves.front().standard_error.back() / curves.front().rmse.back(),
                                    curves[i].standard_error.back() / curves[i].rmse.back());
    }
};

MeasuredVariants measure(const BenchWavelengths& command, const std::string& file, const Device& device,
                         const std::function<void(double share, const std::string& what)>& progress) {
    const Scene scene = load_scene(file);
    RenderOptions base = options_from_scene(scene.settings);
    base.photons_per_pass = 1;
    base.seed = command.seed;
    check_options(base);
    const auto passes = static_cast<std::uint64_t>(command.passes);
    MeasuredVariants measured{file, variants(command, base).variants, {}, 0.0, {}};
    const auto on_device = std::make_shared<const DeviceScene>(scene, base, device);
    progress(0.0, "the exact image");
    measured.exact = exact_image(on_device, base, device, std::min<std::uint64_t>(passes, 256));
    measured.geometric_noise =
        geometric_noise(on_device, measured.variants.front().options, device, std::min(passes, geometry_passes));
    for (const Variant& variant : measured.variants) {
        const auto done = static_cast<double>(measured.curves.size() + 1);
        progress(done / static_cast<double>(measured.variants.size() + 1), variant.label);
        measured.curves.push_back(
            wavelength_error(on_device, variant.options, device, measured.exact.image, passes, command.repeats));
    }
    return measured;
}

/// With as many digits as mean anything.
double rounded(double value) {
    return std::stod(fmt::format("{:.4g}", value));
}

std::vector<double> rounded(std::vector<double> values) {
    std::transform(values.begin(), values.end(), values.begin(), [](double value) { return rounded(value); });
    return values;
}

nlohmann::ordered_json to_json(const MeasuredVariants& measured) {
    nlohmann::ordered_json json{{"scene", measured.scene},
                                {"name", std::filesystem::path(measured.scene).stem().string()},
                                {"exact_error", rounded(measured.exact.error)},
                                {"geometric_noise", rounded(measured.geometric_noise)}};
    for (std::size_t i = 0; i < measured.curves.size(); ++i) {
        const RenderOptions& options = measured.variants[i].options;
        const WavelengthCurve& curve = measured.curves[i];
        json["methods"].push_back({{"method", options.method.name()},
                                   {"sequence", sequence_name(options)},
                                   {"wavelengths", options.method.wavelengths()},
                                   {"unbiased", options.method.unbiased()},
                                   {"passes", curve.passes},
                                   {"rmse", rounded(curve.rmse)},
                                   {"rmse_standard_error", rounded(curve.standard_error)},
                                   {"gain", rounded(measured.gain(i))},
                                   {"gain_standard_error", rounded(measured.gain_error(i))}});
    }
    return json;
}

void print(const MeasuredVariants& measured, const BenchWavelengths& command) {
    fmt::print("{}: RMSE in XYZ over {} repeats; the exact image errs by {:.1e}, paths by {:.1e}\n", measured.scene,
               command.repeats, measured.exact.error, measured.geometric_noise);
    const std::vector<std::uint64_t>& passes = measured.curves.front().passes;
    std::vector<std::size_t> columns;
    for (std::size_t i = 0; i + 1 < passes.size(); i += 4)
        columns.push_back(i);
    columns.push_back(passes.size() - 1);
    fmt::print("{:<32}{:>4}", "method", "W");
    for (const std::size_t column : columns)
        fmt::print("{:>12}", fmt::format("{} passes", passes[column]));
    fmt::print("{:>20}\n", "times smaller");
    for (std::size_t i = 0; i < measured.curves.size(); ++i) {
        const RenderOptions& options = measured.variants[i].options;
        fmt::print("{:<32}{:>4}", options.method.name() + "@" + sequence_name(options), options.method.wavelengths());
        for (const std::size_t column : columns)
            fmt::print("{:>12.2e}", measured.curves[i].rmse[column]);
        fmt::print("{:>12.1f} ± {:<5.1f}\n", measured.gain(i), measured.gain_error(i));
    }
    fmt::print("\n");
}

void run(const BenchWavelengths& command) {
    if (!command.plot.empty())
        check_plot_file(command.plot);
    const Device device = open_device(command.device);
    ProgressBar bar(command.quiet);
    nlohmann::ordered_json results = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < command.scenes.size(); ++i) {
        const std::string& scene = command.scenes[i];
        const MeasuredVariants measured = measure(command, scene, device, [&](double share, const std::string& what) {
            bar.update(static_cast<double>(i) + share, static_cast<double>(command.scenes.size()), scene + ", " + what);
        });
        results.push_back(to_json(measured));
        if (!command.json)
            print(measured, command);
    }
    bar.finish();
    if (command.json)
        fmt::print("{}\n", results.dump(2));
    if (!command.plot.empty())
        write_wavelength_plot(results, command.plot);
}

} // namespace

void add_bench_wavelengths_command(CLI::App& app) {
    CLI::App* sub = app.add_subcommand(
        "bench-wavelengths", "Error that methods make by their wavelengths alone, on scenes without other noise");
    const auto command = std::make_shared<BenchWavelengths>();
    sub->add_option("scenes", command->scenes, "Scene files, such as bench/scenes/*.pbrt")
        ->required()
        ->type_name("SCENE...");
    sub->add_option(
           "--methods", command->methods,
           "Methods as render's --method takes them; METHOD@random and METHOD@stratified choose the wavelength "
           "sequence; tristimulus:1@random, which all are compared with, comes first in any case")
        ->type_name("LIST")
        ->capture_default_str();
    sub->add_option("--passes", command->passes, "Passes of each render; errors are taken at powers of two and the end")
        ->check(CLI::Range(1, most_passes))
        ->capture_default_str();
    sub->add_option("--repeats", command->repeats, "Renders of each method, with other wavelengths")
        ->check(CLI::Range(2, most_repeats))
        ->capture_default_str();
    sub->add_option("--seed", command->seed, "Seed of the first repeat")->capture_default_str();
    sub->add_option("--plot", command->plot, "Draw the errors against the number of passes")->type_name("FILE.png");
    sub->add_flag("--json", command->json, "Print JSON instead of tables");
    sub->add_flag("--quiet", command->quiet, "No progress; errors still show");
    add_device_option(*sub, command->device);
    sub->callback([command] { run(*command); });
}

} // namespace tristim
