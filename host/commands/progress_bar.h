#pragma once

#include "base/stopwatch.h"

#include <optional>
#include <string>

namespace tristim {

/// A bar on stderr for work whose total is known: share done, what is going on, elapsed and remaining time. On a
/// terminal it is rewritten in place ten times a second; elsewhere a new line appears every ten seconds.
class ProgressBar {
  public:
    explicit ProgressBar(bool quiet);

    /// `done` of `total` in any one unit. What was done at the first call does not count for the remaining time.
    void update(double done, double total, const std::string& what);

    /// Clears the bar from the terminal.
    void finish();

  private:
    bool quiet_;
    bool terminal_;
    Stopwatch stopwatch_;
    double last_shown_ = -1e9;
    std::optional<double> done_before_;
};

} // namespace tristim
