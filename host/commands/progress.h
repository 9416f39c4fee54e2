#pragma once

#include "base/stopwatch.h"

#include <cstdint>
#include <optional>
#include <string>

namespace tristim {

/// The progress line of a render on stderr: pass, photons, photons/s, elapsed, remaining. On a terminal it is rewritten
/// in place ten times a second; elsewhere a new line appears every ten seconds.
class Progress {
  public:
    struct Limits {
        std::optional<std::uint64_t> passes;
        std::optional<double> seconds;
    };
    Progress(const Limits& limits, int photons_per_pass, bool quiet);

    void update(std::uint64_t passes);
    void finish(std::uint64_t passes);
    double elapsed() const { return stopwatch_.seconds(); }

  private:
    std::string line(std::uint64_t passes) const;

    Limits limits_;
    int photons_per_pass_;
    bool quiet_;
    bool terminal_;
    Stopwatch stopwatch_;
    double last_shown_ = -1e9;
};

/// "1:02:03", or "2:03" below an hour.
std::string format_duration(double seconds);

} // namespace tristim
