#pragma once

#include "base/stopwatch.h"
#include "render/checkpoint.h"
#include "render/team.h"

#include <CLI/CLI.hpp>

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

namespace tristim {

/// The options that stop and resume a render.
struct CheckpointArguments {
    std::string checkpoint;
    std::string resume;
    std::optional<double> every; ///< s
};

/// Registers --checkpoint, --every and --resume.
void add_checkpoint_options(CLI::App& command, CheckpointArguments& arguments);

/// The checkpoint of a render: what it goes on from, and the file that keeps what it comes to. Either may be missing.
class RenderCheckpoint {
  public:
    /// Reads the file to resume. Throws Error if that cannot be used, the file to write cannot be written or holds what
    /// is not resumed, or options make no sense.
    explicit RenderCheckpoint(const CheckpointArguments& arguments);

    /// A resumed render's method where the options say auto.
    void choose_method(RenderOptions& options) const;

    /// Error estimates go on if the resumed render has what they need; throws Error if they are wanted and it has not.
    void follow_error_sums(RenderOptions& options) const;

    /// Throws Error, naming what differs, unless a resumed render is one of this scene with these options (whose
    /// method has been chosen).
    void check(const Scene& scene, const RenderOptions& options);

    /// Has a team go on from a resumed render. Call it, or give the radii, before anything is written.
    void begin(Team& team);

    /// Writes the file now and then, from what the devices save when asked. A file that cannot be written is
    /// told on stderr, and tried again later.
    void update(PassRenderer& renderer);

    /// Writes the file unless it holds just these passes. Whether it could be written (which it need not, if none is
    /// wanted); if not, stderr tells why. What another process has written there meanwhile is not replaced.
    bool save(RenderSums sums);

    /// How often the file was written and what that took, for --stats.
    nlohmann::ordered_json stats_json() const;

    bool is_wanted() const { return !path_.empty(); }
    const std::string& path() const { return path_; }
    const PassRanges& resumed_passes() const { return resumed_; }
    double resumed_seconds() const { return resumed_seconds_; }

  private:
    std::string path_;        ///< written; or empty
    std::string resume_path_; ///< or empty
    std::optional<double> every_;
    Checkpoint state_; ///< without sums once they were handed to the team
    PassRanges resumed_;
    double resumed_seconds_ = 0.0;
    PassRanges written_;   ///< in the file
    std::string checksum_; ///< of the file as this render knows it
    Stopwatch stopwatch_;
    double written_at_ = 0.0;      ///< on the stopwatch
    double writing_seconds_ = 0.0; ///< the last time
    std::uint64_t times_written_ = 0;
    double all_writing_seconds_ = 0.0;
    bool requested_ = false;
};

} // namespace tristim
