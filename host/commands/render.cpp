#include "commands/render.h"

#include "base/error.h"
#include "base/stopwatch.h"
#include "commands/error_watch.h"
#include "commands/image_output.h"
#include "commands/interrupt.h"
#include "commands/parse.h"
#include "commands/progress.h"
#include "commands/render_arguments.h"
#include "commands/render_checkpoint.h"
#include "image/output_file.h"
#include "render/choose_method.h"
#include "render/image_metadata.h"
#include "render/stats_json.h"
#include "render/team.h"

#include <cmath>
#include <memory>

namespace tristim {
namespace {

constexpr std::uint64_t default_passes = 64;

struct RenderCommand {
    RenderArguments arguments;
    ImageOutput image;
    CheckpointArguments checkpoint;
    std::optional<std::uint64_t> passes;
    std::optional<double> seconds;
    std::string pass_range;
    std::optional<double> error_target;
    std::string stats;
    bool quiet = false;
};

std::vector<DeviceInfo> infos(const std::vector<Device>& devices) {
    std::vector<DeviceInfo> result;
    for (const Device& device : devices)
        result.push_back(device.info);
    return result;
}

RenderBudget limits(const RenderCommand& command, const Scene& scene) {
    if (command.seconds)
        check_seconds(*command.seconds, "--time");
    if (!command.pass_range.empty()) {
        const PassRanges range = PassRanges::parse(command.pass_range);
        if (range.ranges().size() != 1)
            fail("--pass-range {} is not one range", command.pass_range);
        return {range.count(), command.seconds, range.ranges().front().begin};
    }
    if (!command.passes && !command.seconds && command.error_target)
        return {};
    if (!command.passes && !command.seconds)
        return {scene.settings.passes ? static_cast<std::uint64_t>(*scene.settings.passes) : default_passes, {}};
    return {command.passes, command.seconds};
}

/// Renders passes until a limit or the error target is reached, the user interrupts or no device is left.
RenderOutcome render_passes(Team& team, const RenderOptions& options, const RenderBudget& limits,
                            const RenderCommand& command, RenderCheckpoint& checkpoint) {
    const std::uint64_t earlier = checkpoint.resumed_passes().count();
    RenderBudget left = limits;
    if (limits.passes)
        left.passes = passes_to_do(limits, checkpoint.resumed_passes()).count();
    Progress progress(left, options.photons_per_pass, command.quiet, earlier);
    ErrorWatch watch(command.error_target, options.region.width);
    const Stopwatch stopwatch;
    checkpoint.begin(team);
    team.render(limits, [&](std::uint64_t done) {
        progress.update(done, watch.text(), watch.remaining(earlier + done, done, stopwatch.seconds()));
        checkpoint.update(team);
        return !watch.reached(team, earlier + done) && !interrupted();
    });
    RenderOutcome outcome = team.outcome();
    progress.finish(outcome.statistics.passes - earlier);
    outcome.statistics.render_seconds += checkpoint.resumed_seconds();
    return outcome;
}

/// Tells of the devices that failed. Whether the others did without them what was asked for.
bool report_failures(const RenderOutcome& outcome, const RenderBudget& limits) {
    std::size_t failed = 0;
    for (const DeviceShare& share : outcome.shares) {
        if (share.failure.empty())
            continue;
        ++failed;
        fmt::print(stderr, "{}: device '{}' failed after {} passes: {}\n",
                   failed == outcome.shares.size() ? "error" : "warning", share.device.name, share.passes,
                   share.failure);
    }
    return failed < outcome.shares.size() || passes_to_do(limits, outcome.sums.passes).empty();
}

/// "A" or "A (41 passes), B (23 passes)".
std::string describe(const std::vector<DeviceShare>& shares) {
    if (shares.size() == 1)
        return shares.front().device.name;
    std::vector<std::string> parts;
    for (const DeviceShare& share : shares)
        parts.push_back(fmt::format("{} ({} passes)", share.device.name, share.passes));
    return fmt::format("{}", fmt::join(parts, ", "));
}

/// The estimate and, if there is a target, whether it is reached.
std::string describe(const ErrorEstimate& estimate, std::optional<double> target) {
    return describe(estimate) +
           (target ? fmt::format(", {}under the target {:.2g}", estimate.rmse < *target ? "" : "not ", *target) : "");
}

/// --method auto: fills in the method, and says which and why.
void choose(const std::shared_ptr<const DeviceScene>& scene, const Device& device, const RenderBudget& budget,
            bool quiet, RenderOptions& options) {
    StatusLine status(quiet);
    const MethodChoice choice = choose_method(scene, options, device, budget, [&](const Method& method) {
        if (status.due())
            status.show("auto: trying " + method.name());
        return !interrupted();
    });
    status.finish();
    options.method = choice.method;
    options.auto_method = false;
    if (!quiet && !interrupted())
        fmt::print(stderr, "{}", describe(choice));
}

void run(RenderCommand& command) {
    const Stopwatch loading;
    const Scene scene = load_scene(command.arguments.scene, command.arguments.rgb_upsampling);
    const double load_seconds = loading.seconds();
    RenderOptions options = resolve_options(command.arguments, scene);
    if (command.error_target && !(*command.error_target > 0.0 && std::isfinite(*command.error_target)))
        fail("--error-target must be a positive number");
    options.error_estimate = command.error_target || wants_error_estimate(command.image);
    const RenderBudget stop = limits(command, scene);
    if (command.image.outfiles.empty())
        command.image.outfiles.push_back(scene.settings.filename);
    RenderCheckpoint checkpoint(command.checkpoint);
    check(command.image, checkpoint.path());
    if (!command.stats.empty())
        check_output_file(command.stats);
    if (!command.quiet)
        print_notes(scene);

    checkpoint.choose_method(options);
    checkpoint.follow_error_sums(options);
    if (!options.auto_method)
        checkpoint.check(scene, options);
    catch_interrupts();
    const std::vector<Device> devices = open_devices(command.arguments.device);
    std::shared_ptr<const DeviceScene> device_scene;
    if (options.auto_method) {
        device_scene = std::make_shared<const DeviceScene>(scene, options, devices.front());
        choose(device_scene, devices.front(), stop, command.quiet, options);
        checkpoint.check(scene, options);
    }
    Team team(scene, options, devices, device_scene);
    const RenderOutcome outcome = render_passes(team, options, stop, command, checkpoint);
    const RenderStatistics& statistics = outcome.statistics;
    const bool complete = report_failures(outcome, stop);
    if (statistics.passes == 0)
        fail("{} before the first pass was done: no image written",
             interrupted() ? "interrupted" : "no device was left");

    const bool saved = checkpoint.save(outcome.sums);
    const FilmImage film = developed(outcome.sums, options);
    const ErrorEstimate estimate = estimate_error(outcome.sums, options.region.width);
    write(
        command.image, xyz_image(film),
        with_passes(image_metadata(options, statistics, infos(devices), command.arguments.scene, film.rejected_samples),
                    outcome.sums.passes),
        estimate, outcome.sums.film);
    if (!command.stats.empty()) {
        nlohmann::ordered_json json = stats_json(options, outcome, command.arguments.scene, load_seconds, estimate);
        if (checkpoint.is_wanted())
            json["checkpoints"] = checkpoint.stats_json();
        replace_file(command.stats, json.dump(2) + "\n");
    }
    if (film.rejected_samples > 0)
        fmt::print(stderr, "warning: {} values were not finite and left out: {}\n", film.rejected_samples,
                   describe(outcome.sums.non_finite));
    std::vector<std::string> written = command.image.outfiles;
    if (checkpoint.is_wanted() && saved)
        written.push_back(checkpoint.path());
    if (!command.quiet)
        fmt::print(stderr,
                   "{}{} passes on {} in {:.1f} s, {:.1f} s building kernels; {}; {} non-finite values; wrote {}\n",
                   interrupted() ? "interrupted: " : "", statistics.passes, describe(outcome.shares),
                   statistics.render_seconds, statistics.build_kernels_seconds,
                   describe(estimate, command.error_target), film.rejected_samples, fmt::join(written, ", "));
    if (!interrupted())
        team.keep_programs();
    if (!complete || !saved)
        throw CLI::RuntimeError(1);
    if (interrupted() && !(stop.passes && passes_to_do(stop, outcome.sums.passes).empty()))
        throw CLI::RuntimeError(exit_interrupted_and_saved);
}

} // namespace

void add_render_command(CLI::App& app) {
    auto command = std::make_shared<RenderCommand>();
    command->arguments.accepts_auto = true;
    CLI::App* sub = app.add_subcommand("render", "Render a scene to EXR and PNG images");
    sub->footer(
        fmt::format("Ctrl-C and SIGTERM end a render after the passes under way, which are saved as any others; "
                    "the exit status is {} then. A second one ends it at once.",
                    exit_interrupted_and_saved));
    add_render_arguments(*sub, command->arguments);
    add_image_output(*sub, command->image, "Image to write, may be repeated [the scene's film filename]");
    auto* passes = sub->add_option("--passes", command->passes,
                                   "Passes to render, resumed ones included [scene's pixelsamples, else 64]")
                       ->check(CLI::PositiveNumber);
    sub->add_option("--pass-range", command->pass_range,
                    "Render only passes A to B - 1 of an image, see `tristim merge`")
        ->type_name("A:B")
        ->excludes(passes);
    add_checkpoint_options(*sub, command->checkpoint);
    sub->add_option("--time", command->seconds, "Seconds to render; with --passes, the first reached ends the render");
    sub->add_option(
           "--error-target", command->error_target,
           "Render until the estimated RMSE falls under X, or to the limit by --passes, --time or --pass-range, "
           "whichever is first. The RMSE is over pixels and X, Y, Z, as `tristim compare` has it, divided by the "
           "mean Y of the image; noise and the search radius's bias count")
        ->type_name("X");
    sub->add_option("--stats", command->stats, "Write times, rays and memory as JSON")->type_name("FILE.json");
    sub->add_flag("--quiet", command->quiet, "No progress, notes or summary; errors still show");
    sub->callback([command] { run(*command); });
}

} // namespace tristim
