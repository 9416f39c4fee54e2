#include "commands/bench.h"

#include "base/error.h"
#include "base/tell.h"
#include "bench/bench.h"
#include "bench/machine.h"
#include "bench/reference.h"
#include "bench/regions.h"
#include "commands/interrupt.h"
#include "commands/parse.h"
#include "commands/progress_bar.h"
#include "commands/render_arguments.h"
#include "report/report.h"

#include <chrono>
#include <fmt/chrono.h>
#include <memory>

namespace tristim {
namespace {

constexpr int exit_interrupted = 130; // as shells report SIGINT
constexpr double reference_factor = 10.0;
constexpr int most_repeats = 1000;

struct BenchCommand {
    RenderArguments arguments; ///< but for scene, method and device
    std::vector<std::string> scenes;
    std::string methods = "rgb,spectral:400,tristimulus:1,tristimulus:20";
    bool costs = false;
    double seconds = 0.0;
    std::string out;
    std::vector<std::string> references;
    std::optional<double> reference_seconds;
    std::string reference_method = "spectral:400";
    std::vector<std::string> regions;
    int repeats = 1;
    std::vector<std::string> devices;
    bool resume = false;
    bool quiet = false;
    std::string command_line;
};

void check(const BenchCommand& command) {
    check_seconds(command.seconds, "--time");
    if (command.reference_seconds)
        check_seconds(*command.reference_seconds, "--reference-time");
    if (command.repeats < 1 || command.repeats > most_repeats)
        fail("{} repeats is not between 1 and {}", command.repeats, most_repeats);
    if (!command.references.empty() && command.references.size() != command.scenes.size())
        fail("the number of scenes is {} but that of --reference {}: each scene takes one, in the same order",
             command.scenes.size(), command.references.size());
}

/// What a bench of this scene renders, devices aside; throws before anything is rendered or built.
PlannedScene plan(const BenchCommand& command, const std::string& file, const std::vector<Device>& devices) {
    Scene scene = load_scene(file, command.arguments.rgb_upsampling);
    RenderArguments arguments = command.arguments;
    arguments.method = command.costs ? "tristimulus:1" : "spectral:400";
    RenderOptions base = resolve_options(arguments, scene);
    std::vector<VariantGroup> groups =
        command.costs ? cost_variants(base) : std::vector{method_variants(command.methods, base)};
    std::vector<NamedRegion> regions = named_regions(scene, base, command.regions);
    PlannedScene planned = plan_scene(std::move(scene), file, groups, devices, std::move(regions));
    planned.reference_options = base;
    planned.reference_options.method = parse_method(command.reference_method);
    planned.reference_options.seed = reference_seed;
    planned.reference_options.statistics_radius = false;
    planned.reference_options.fast_math = false;
    return planned;
}

BenchPlan plan(const BenchCommand& command) {
    BenchPlan plan;
    plan.folder = command.out;
    plan.reference_seconds = command.reference_seconds.value_or(reference_factor * command.seconds);
    for (const std::string& selector : command.devices.empty() ? std::vector<std::string>{""} : command.devices) {
        plan.devices.push_back(open_device(selector));
        plan.results.devices.push_back(describe_device(plan.devices.back()));
    }
    for (std::size_t i = 0; i < command.scenes.size(); ++i) {
        plan.scenes.push_back(tristim::plan(command, command.scenes[i], plan.devices));
        if (!command.references.empty())
            plan.scenes.back().given_reference = command.references[i];
        if (!command.quiet)
            print_notes(plan.scenes.back().scene);
    }
    make_names_unique(plan.scenes);
    BenchResults& results = plan.results;
    results.kind = command.costs ? "costs" : "methods";
    results.version = TRISTIM_VERSION;
    results.started =
        fmt::format("{:%FT%TZ}", fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
    results.command = command.command_line;
    results.machine = describe_machine();
    results.seconds = command.seconds;
    results.repeats = command.repeats;
    results.seed = command.arguments.seed.value_or(0);
    return plan;
}

void run(const BenchCommand& command) {
    check(command);
    BenchPlan bench = plan(command);
    catch_interrupts();
    ProgressBar bar(command.quiet);
    const bool complete = run_bench(bench, command.resume, [&](const BenchProgress& progress) {
        bar.update(progress.done, progress.total, progress.what);
        return !interrupted();
    });
    bar.finish();
    write_report(command.out);
    if (!command.quiet)
        tell("wrote results.json, results.csv, plots and report.html in {}\n", command.out);
    if (!complete) {
        tell("interrupted: what was measured is kept, --resume goes on\n");
        throw CLI::RuntimeError(exit_interrupted);
    }
}

} // namespace

void add_bench_command(CLI::App& app, std::string command_line) {
    auto command = std::make_shared<BenchCommand>();
    command->command_line = std::move(command_line);
    CLI::App* sub = app.add_subcommand(
        "bench", "Error against time: methods or settings, on scenes, with curves, tables and a report");
    sub->add_option("scenes", command->scenes, "Scene files")->required()->type_name("SCENE...");
    auto* methods = sub->add_option("--methods", command->methods,
                                    "Methods as render's --method takes them; METHOD@random and METHOD@stratified "
                                    "choose the wavelength sequence of one")
                        ->type_name("LIST")
                        ->capture_default_str();
    sub->add_flag("--costs", command->costs,
                  "Instead of methods, compare what a render can be given more or less of: wavelengths, photons, "
                  "radius, alpha, arithmetic, direct light; the other options give the baseline of tristimulus:1")
        ->excludes(methods);
    sub->add_option("--time", command->seconds, "Seconds of rendering for each scene, method and repeat")->required();
    sub->add_option("--out", command->out, "Folder for results.json, results.csv, plots, images and report.html")
        ->required()
        ->type_name("DIR");
    sub->add_option("--reference", command->references,
                    "Reference that `tristim reference` wrote, one for each scene in their order [rendered into DIR]")
        ->type_name("REF.exr")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    sub->add_option("--reference-time", command->reference_seconds,
                    "Seconds for each reference that is rendered into DIR [10 times --time]")
        ->type_name("SECONDS");
    sub->add_option("--reference-method", command->reference_method,
                    "Method of references that are rendered into DIR; another unbiased one can be far less noisy")
        ->type_name("METHOD")
        ->capture_default_str();
    sub->add_option("--regions", command->regions,
                    "Part of the image whose error is also measured by itself; may be repeated [those kept beside the "
                    "scene, in SCENE.regions]")
        ->type_name("NAME=X0,Y0,X1,Y1")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    sub->add_option("--repeats", command->repeats, "Renders of each method, with seeds SEED, SEED+1, ...")
        ->capture_default_str();
    sub->add_option("--devices", command->devices, "OpenCL devices to compare: indices or parts of names [first CPU]")
        ->type_name("LIST")
        ->delimiter(',')
        ->allow_extra_args(false);
    sub->add_flag("--resume", command->resume, "Go on with the bench in DIR that was interrupted");
    sub->add_flag("--quiet", command->quiet, "No progress, notes or summary; errors still show");
    add_render_settings(*sub, command->arguments);
    sub->get_option("--seed")->description("Seed of the first repeat [0]");
    sub->callback([command] { run(*command); });
}

} // namespace tristim
