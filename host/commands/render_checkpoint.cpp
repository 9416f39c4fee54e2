#include "commands/render_checkpoint.h"

#include "base/error.h"
#include "base/tell.h"
#include "commands/parse.h"
#include "image/output_file.h"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace tristim {
namespace {

/// Seconds between checkpoints, where --every does not say: so many, and so many times what writing one takes.
constexpr double default_seconds = 60.0;
constexpr double seconds_per_writing_second = 100.0;

bool exists(const std::string& path) {
    std::error_code ignored;
    return std::filesystem::exists(path, ignored);
}

} // namespace

void add_checkpoint_options(CLI::App& command, CheckpointArguments& arguments) {
    command
        .add_option("--checkpoint", arguments.checkpoint,
                    "Save now and then, and at the end, what --resume goes on from and `tristim merge` adds up")
        ->type_name("FILE.exr")
        ->check(not_empty());
    command
        .add_option("--resume", arguments.resume,
                    "Go on from a checkpoint, and save to it unless --checkpoint names another file; "
                    "if both name one file, it need not be there yet")
        ->type_name("FILE.exr")
        ->check(not_empty());
    command
        .add_option("--every", arguments.every,
                    fmt::format("Seconds between checkpoints [{}, or {} times what saving takes if that is more]",
                                default_seconds, seconds_per_writing_second))
        ->type_name("SECONDS");
}

RenderCheckpoint::RenderCheckpoint(const CheckpointArguments& arguments)
    : path_(arguments.checkpoint.empty() ? arguments.resume : arguments.checkpoint), resume_path_(arguments.resume),
      every_(arguments.every) {
    if (every_)
        check_seconds(*every_, "--every");
    if (every_ && path_.empty())
        fail("--every needs --checkpoint or --resume");
    const bool one_file = !resume_path_.empty() && is_same_file(path_, resume_path_);
    if (one_file && !arguments.checkpoint.empty() && !exists(resume_path_))
        resume_path_.clear();
    if (!resume_path_.empty()) {
        state_ = read_checkpoint(resume_path_);
        resumed_ = state_.sums.passes;
        resumed_seconds_ = state_.seconds;
        if (one_file) {
            written_ = resumed_;
            checksum_ = state_.checksum;
        }
    }
    if (path_.empty())
        return;
    one_file ? check_output_file(path_) : check_new_checkpoint(path_);
    remove_leftovers(path_);
}

void RenderCheckpoint::choose_method(RenderOptions& options) const {
    if (resume_path_.empty() || !options.auto_method)
        return;
    options.method = parse_method(value_of(state_.identity, "method"));
    options.auto_method = false;
}

void RenderCheckpoint::follow_error_sums(RenderOptions& options) const {
    if (resume_path_.empty())
        return;
    if (options.error_estimate && state_.sums.error.empty())
        fail(
            "cannot resume \"{}\" with error estimates: it was begun without --aov error, --aov bias or --error-target",
            resume_path_);
    options.error_estimate = !state_.sums.error.empty();
}

void RenderCheckpoint::check(const Scene& scene, const RenderOptions& options) {
    if (path_.empty())
        return;
    const RenderIdentity wanted = render_identity(scene, options);
    const std::string difference = resume_path_.empty() ? "" : describe_difference(state_.identity, wanted);
    if (!difference.empty())
        fail("cannot resume \"{}\": {}", resume_path_, difference);
    state_.identity = wanted;
    state_.width = options.width;
    state_.height = options.height;
    state_.region = options.region;
    state_.scene = scene.path;
}

void RenderCheckpoint::begin(Team& team) {
    if (path_.empty())
        return;
    if (!resume_path_.empty())
        team.resume(state_.sums, state_.initial_radii);
    else
        state_.initial_radii = team.initial_radii();
    state_.sums = {};
    for (const DeviceInfo& device : team.devices()) {
        if (state_.devices.find(device.name) == std::string::npos)
            state_.devices += (state_.devices.empty() ? "" : ", ") + device.name;
    }
    stopwatch_ = Stopwatch();
}

void RenderCheckpoint::update(PassRenderer& renderer) {
    if (path_.empty())
        return;
    const double every = every_.value_or(std::max(default_seconds, seconds_per_writing_second * writing_seconds_));
    if (!requested_ && stopwatch_.seconds() - written_at_ < every)
        return;
    if (!requested_)
        renderer.request_sums();
    std::optional<RenderSums> sums = renderer.requested_sums();
    requested_ = !sums;
    if (sums) {
        save(std::move(*sums));
        writing_seconds_ += renderer.summing_seconds();
    }
}

nlohmann::ordered_json RenderCheckpoint::stats_json() const {
    return {{"file", path_}, {"written", times_written_}, {"seconds", all_writing_seconds_}};
}

bool RenderCheckpoint::save(RenderSums sums) {
    if (path_.empty() || sums.passes == written_)
        return true;
    const Stopwatch writing;
    bool written = true;
    state_.sums = std::move(sums);
    state_.seconds = resumed_seconds_ + stopwatch_.seconds();
    try {
        if (exists(path_) && checksum_in(path_) != checksum_)
            fail("another process has written \"{}\" meanwhile, and what it saved stays there", path_);
        checksum_ = write_checkpoint(path_, state_);
        written_ = state_.sums.passes;
        ++times_written_;
    } catch (const std::exception& error) {
        const bool still_there = !written_.empty() && checksum_in(path_) == checksum_;
        tell("warning: no checkpoint of {} passes: {}{}\n", state_.sums.passes.count(), error.what(),
             still_there ? fmt::format("; that of {} passes is still there", written_.count()) : "");
        written = false;
    }
    state_.sums = {};
    writing_seconds_ = writing.seconds();
    all_writing_seconds_ += writing_seconds_;
    written_at_ = stopwatch_.seconds();
    return written;
}

} // namespace tristim
