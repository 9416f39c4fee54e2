#include "commands/render.h"

#include "base/error.h"
#include "base/stopwatch.h"
#include "base/tell.h"
#include "commands/error_watch.h"
#include "commands/image_output.h"
#include "commands/interrupt.h"
#include "commands/parse.h"
#include "commands/progress.h"
#include "commands/render_arguments.h"
#include "commands/render_checkpoint.h"
#include "image/output_file.h"
#include "mpi/agree.h"
#include "mpi/joint_render.h"
#include "mpi/launcher.h"
#include "opencl/errors.h"
#include "render/choose_method.h"
#include "render/image_metadata.h"
#include "render/stats_json.h"
#include "render/team.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

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

/// Of the devices that took part; of those of several ranks, each kind once.
std::vector<DeviceInfo> devices(const std::vector<DeviceShare>& shares) {
    std::vector<DeviceInfo> result;
    for (const DeviceShare& share : shares) {
        const bool known = std::any_of(result.begin(), result.end(), [&](const DeviceInfo& info) {
            return info.name == share.device.name && info.driver == share.device.driver;
        });
        if (shares.back().rank == 0 || (!known && !share.device.name.empty()))
            result.push_back(share.device);
    }
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
RenderOutcome render_passes(PassRenderer& renderer, const RenderOptions& options, const RenderBudget& limits,
                            const RenderCommand& command, RenderCheckpoint& checkpoint) {
    const std::uint64_t earlier = checkpoint.resumed_passes().count();
    RenderBudget left = limits;
    if (limits.passes)
        left.passes = passes_to_do(limits, checkpoint.resumed_passes()).count();
    Progress progress(left, options.photons_per_pass, command.quiet, earlier);
    ErrorWatch watch(command.error_target, options.region.width);
    const Stopwatch stopwatch;
    renderer.render(limits, [&](std::uint64_t done) {
        progress.update(done, watch.text(), watch.remaining(earlier + done, done, stopwatch.seconds()));
        checkpoint.update(renderer);
        return !watch.reached(renderer, earlier + done) && !interrupted();
    });
    RenderOutcome outcome = renderer.outcome();
    progress.finish(outcome.statistics.passes - earlier);
    outcome.statistics.render_seconds += checkpoint.resumed_seconds();
    return outcome;
}

/// Tells of the devices that failed. Whether the others did without them what was asked for.
bool report_failures(const RenderOutcome& outcome, const RenderBudget& limits) {
    const bool ranks = outcome.shares.back().rank > 0;
    std::size_t failed = 0;
    for (const DeviceShare& share : outcome.shares) {
        if (share.failure.empty())
            continue;
        ++failed;
        const char* kind = failed == outcome.shares.size() ? "error" : "warning";
        if (share.device.name.empty())
            tell("{}: rank {} takes no part: {}\n", kind, share.rank, share.failure);
        else
            tell("{}: {}device '{}' failed after {} passes: {}\n", kind,
                 ranks ? fmt::format("rank {}'s ", share.rank) : "", share.device.name, share.passes, share.failure);
    }
    return failed < outcome.shares.size() || passes_to_do(limits, outcome.sums.passes).empty();
}

/// "A" or "A (41 passes), B (23 passes)"; of several ranks, "8 ranks: 8 × A (64 passes)".
std::string describe(const std::vector<DeviceShare>& shares) {
    if (shares.size() == 1)
        return shares.front().device.name;
    std::vector<std::string> parts;
    if (shares.back().rank == 0) {
        for (const DeviceShare& share : shares)
            parts.push_back(fmt::format("{} ({} passes)", share.device.name, share.passes));
        return fmt::format("{}", fmt::join(parts, ", "));
    }
    std::map<std::string, std::pair<int, std::uint64_t>> kinds; // how many, and their passes
    for (const DeviceShare& share : shares) {
        if (share.device.name.empty())
            continue;
        auto& [count, passes] = kinds[share.device.name];
        ++count;
        passes += share.passes;
    }
    for (const auto& [name, kind] : kinds)
        parts.push_back(fmt::format("{} × {} ({} passes)", kind.first, name, kind.second));
    return fmt::format("{} ranks: {}", shares.back().rank + 1, fmt::join(parts, ", "));
}

/// The estimate and, if there is a target, whether it is reached.
std::string describe(const ErrorEstimate& estimate, std::optional<double> target) {
    return describe(estimate) +
           (target ? fmt::format(", {}under the target {:.2g}", estimate.rmse < *target ? "" : "not ", *target) : "");
}

constexpr const char* interrupted_early = "interrupted before the first pass was done: no image written";

/// The error of a step whose failure may be but a signal's: it has PoCL's compiler remove its files, and then fail.
std::string describe_failure() {
    return interrupted() ? interrupted_early : describe_current_exception();
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
        tell("{}", describe(choice));
}

/// What is known before the device does anything.
struct Prepared {
    Scene scene;
    RenderOptions options;
    RenderBudget limits;
    std::vector<Device> devices;
    std::unique_ptr<RenderCheckpoint> checkpoint; ///< that of rank 0; others have none to read or write
    double load_seconds = 0.0;
};

/// Throws Error if the file for --stats cannot be written, or is that of something else.
void check_stats(const RenderCommand& command, const std::string& checkpoint) {
    check_output_file(command.stats);
    const auto is_stats = [&](const std::string& path) { return is_same_file(path, command.stats); };
    if (is_stats(checkpoint) || is_checkpoint(command.stats))
        fail("cannot write statistics to \"{}\": a checkpoint is there, or will be", command.stats);
    if (std::any_of(command.image.outfiles.begin(), command.image.outfiles.end(), is_stats))
        fail("cannot write statistics to \"{}\": an image will be there", command.stats);
}

Prepared prepare(RenderCommand& command, const Communicator* ranks) {
    const bool first = ranks == nullptr || ranks->rank() == 0;
    const Stopwatch loading;
    Prepared prepared;
    prepared.scene = load_scene(command.arguments.scene, command.arguments.rgb_upsampling);
    prepared.load_seconds = loading.seconds();
    RenderOptions& options = prepared.options = resolve_options(command.arguments, prepared.scene);
    if (command.error_target && !(*command.error_target > 0.0 && std::isfinite(*command.error_target)))
        fail("--error-target must be a positive number");
    options.error_estimate = command.error_target || wants_error_estimate(command.image);
    prepared.limits = limits(command, prepared.scene);
    if (ranks != nullptr && options.statistics_radius)
        fail("--radius statistics needs each pass after those before it, so one process, not {}", ranks->size());
    if (command.image.outfiles.empty())
        command.image.outfiles.push_back(prepared.scene.settings.filename);
    prepared.checkpoint = std::make_unique<RenderCheckpoint>(first ? command.checkpoint : CheckpointArguments{});
    if (first) {
        check(command.image, prepared.checkpoint->path());
        if (!command.stats.empty())
            check_stats(command, prepared.checkpoint->path());
    } else {
        command.quiet = true;
        command.error_target.reset();
    }
    if (!command.quiet)
        print_notes(prepared.scene);

    prepared.checkpoint->choose_method(options);
    prepared.checkpoint->follow_error_sums(options);
    if (!options.auto_method)
        prepared.checkpoint->check(prepared.scene, options);
    catch_interrupts(ranks != nullptr);
    if (ranks == nullptr)
        prepared.devices = open_devices(command.arguments.device);
    else
        prepared.devices = {open_device_in_turn(command.arguments.device, ranks->local_rank())};
    const bool on_cpu = (prepared.devices.front().info.type & CL_DEVICE_TYPE_CPU) != 0;
    const std::string note = ranks != nullptr && on_cpu ? binding_note(ranks->local_size()) : "";
    if (!command.quiet && !note.empty())
        tell("note: {}\n", note);
    return prepared;
}

/// --method auto: rank 0 chooses for all. And a checkpoint that it resumes may leave nothing to estimate errors from.
std::shared_ptr<const DeviceScene> choose(Prepared& prepared, bool quiet, Communicator* ranks) {
    RenderOptions& options = prepared.options;
    std::shared_ptr<const DeviceScene> device_scene;
    at_first_rank(ranks, [&] {
        if (options.auto_method) {
            device_scene = std::make_shared<const DeviceScene>(prepared.scene, options, prepared.devices.front());
            try {
                choose(device_scene, prepared.devices.front(), prepared.limits, quiet, options);
            } catch (const std::exception&) {
                fail("{}", describe_failure());
            }
            prepared.checkpoint->check(prepared.scene, options);
        }
        return 0;
    });
    if (ranks != nullptr) {
        options.method = parse_method(ranks->broadcast(options.method.name()));
        options.auto_method = false;
        options.error_estimate = ranks->broadcast(options.error_estimate ? "yes" : "no") == "yes";
    }
    return device_scene;
}

/// What renders on the devices of this process, or of all ranks.
std::unique_ptr<PassRenderer> make_renderer(Prepared& prepared, bool quiet, Communicator* ranks) {
    const std::shared_ptr<const DeviceScene> device_scene = choose(prepared, quiet, ranks);
    if (ranks != nullptr)
        check_same_image(*ranks, prepared.scene, prepared.options);
    std::unique_ptr<Team> team;
    std::string failure;
    at_all_ranks(ranks, [&] {
        try {
            team = std::make_unique<Team>(prepared.scene, prepared.options, prepared.devices, device_scene);
            prepared.checkpoint->begin(*team);
        } catch (const std::exception&) {
            failure = describe_failure();
            if (ranks == nullptr || ranks->rank() == 0)
                fail("{}", failure);
        }
    });
    if (ranks == nullptr)
        return team;
    return std::make_unique<JointRender>(*ranks, prepared.options, std::move(team), failure,
                                         prepared.checkpoint->resumed_passes());
}

/// Writes what was asked for, and tells of it. The exit status.
int finish(const RenderCommand& command, const Prepared& prepared, const RenderOutcome& outcome) {
    const RenderOptions& options = prepared.options;
    const bool stopped = interrupted() || outcome.stopped_elsewhere;
    const RenderStatistics& statistics = outcome.statistics;
    const bool complete = report_failures(outcome, prepared.limits);
    if (statistics.passes == 0)
        fail("{}", stopped ? interrupted_early : "no device was left before the first pass was done: no image written");

    const bool saved = prepared.checkpoint->save(outcome.sums);
    const FilmImage film = developed(outcome.sums, options);
    const ErrorEstimate estimate = estimate_error(outcome.sums, options.region.width);
    write(command.image, xyz_image(film),
          with_passes(image_metadata(options, statistics, devices(outcome.shares), command.arguments.scene,
                                     film.rejected_samples),
                      outcome.sums.passes),
          estimate, outcome.sums.film);
    if (!command.stats.empty()) {
        nlohmann::ordered_json json =
            stats_json(options, outcome, command.arguments.scene, prepared.load_seconds, estimate);
        if (prepared.checkpoint->is_wanted())
            json["checkpoints"] = prepared.checkpoint->stats_json();
        replace_file(command.stats, json.dump(2) + "\n");
    }
    if (film.rejected_samples > 0)
        tell("warning: {} values were not finite and left out: {}\n", film.rejected_samples,
             describe(outcome.sums.non_finite));
    std::vector<std::string> written = command.image.outfiles;
    if (prepared.checkpoint->is_wanted() && saved)
        written.push_back(prepared.checkpoint->path());
    if (!command.quiet)
        tell("{}{} passes on {} in {:.1f} s, {:.1f} s building kernels; {}; {} non-finite values; wrote {}\n",
             stopped ? "interrupted: " : "", statistics.passes, describe(outcome.shares), statistics.render_seconds,
             statistics.build_kernels_seconds, describe(estimate, command.error_target), film.rejected_samples,
             fmt::join(written, ", "));
    if (!complete || !saved)
        return 1;
    const bool all_done = prepared.limits.passes && passes_to_do(prepared.limits, outcome.sums.passes).empty();
    return stopped && !all_done ? exit_interrupted_and_saved : 0;
}

void run(RenderCommand& command) {
    Communicator* const ranks = join_ranks();
    Prepared prepared;
    at_all_ranks(ranks, [&] { prepared = prepare(command, ranks); });
    const std::unique_ptr<PassRenderer> renderer = make_renderer(prepared, command.quiet, ranks);
    const RenderOutcome outcome =
        render_passes(*renderer, prepared.options, prepared.limits, command, *prepared.checkpoint);
    const int exit_status = at_first_rank(ranks, [&] { return finish(command, prepared, outcome); });
    if (!interrupted())
        renderer->keep_programs();
    leave_ranks();
    if (exit_status != 0)
        throw CLI::RuntimeError(exit_status);
}

} // namespace

void add_render_command(CLI::App& app) {
    auto command = std::make_shared<RenderCommand>();
    command->arguments.accepts_auto = true;
    CLI::App* sub = app.add_subcommand("render", "Render a scene to EXR and PNG images");
    sub->footer(fmt::format(
        "Ctrl-C, SIGTERM and SIGHUP end a render after the passes under way, which are saved as any others; "
        "the exit status is {} then. Another one after half a second or more ends it at once.",
        exit_interrupted_and_saved));
    add_render_arguments(*sub, command->arguments);
    add_image_output(*sub, command->image, "Image to write, may be repeated [the scene's film filename]");
    auto* passes = sub->add_option("--passes", command->passes,
                                   "Passes to render, resumed ones included [scene's pixelsamples, else 64]")
                       ->check(CLI::PositiveNumber);
    sub->add_option("--pass-range", command->pass_range,
                    "Render only passes A to B - 1 of an image, see `tristim merge`")
        ->type_name("A:B")
        ->check(not_empty())
        ->excludes(passes);
    add_checkpoint_options(*sub, command->checkpoint);
    sub->add_option("--time", command->seconds, "Seconds to render; with --passes, the first reached ends the render");
    sub->add_option(
           "--error-target", command->error_target,
           "Render until the estimated RMSE falls under X, or to the limit by --passes, --time or --pass-range, "
           "whichever is first. The RMSE is over pixels and X, Y, Z, as `tristim compare` has it, divided by the "
           "mean Y of the image; noise and the search radius's bias count")
        ->type_name("X");
    sub->add_option("--stats", command->stats, "Write times, rays and memory as JSON")
        ->type_name("FILE.json")
        ->check(not_empty());
    sub->add_flag("--quiet", command->quiet, "No progress, notes or summary; errors still show");
    sub->callback([command] { run(*command); });
}

} // namespace tristim
