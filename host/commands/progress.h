#pragma once

#include "commands/status_line.h"
#include "render/options.h"

#include <cstdint>
#include <optional>
#include <string>

namespace tristim {

/// The status line of a render: pass, photons, photons/s, elapsed, remaining.
class Progress {
  public:
    /// Passes are shown with those that earlier renders have done; `limits` has those that are left.
    Progress(const RenderBudget& limits, int photons_per_pass, bool quiet, std::uint64_t earlier_passes = 0);

    /// Passes of this render alone. `more` is shown too; `remaining` are seconds to another end than those of the
    /// limits.
    void update(std::uint64_t passes, const std::string& more = {}, std::optional<double> remaining = {});
    void finish(std::uint64_t passes);
    double elapsed() const { return status_.elapsed(); }

  private:
    std::string line(std::uint64_t passes, const std::string& more, std::optional<double> other_end) const;

    RenderBudget limits_;
    int photons_per_pass_;
    std::uint64_t earlier_passes_;
    StatusLine status_;
};

/// "1:02:03", or "2:03" below an hour.
std::string format_duration(double seconds);

} // namespace tristim
