#pragma once

#include "commands/status_line.h"

#include <optional>
#include <string>

namespace tristim {

/// The status line of work whose total is known: a bar, share done, what is going on, elapsed and remaining time.
class ProgressBar {
  public:
    explicit ProgressBar(bool quiet) : status_(quiet) {}

    /// `done` of `total` in any one unit. What was done at the first call does not count for the remaining time.
    void update(double done, double total, const std::string& what);

    /// Clears the bar from the terminal.
    void finish() { status_.finish(); }

  private:
    StatusLine status_;
    std::optional<double> done_before_;
};

} // namespace tristim
