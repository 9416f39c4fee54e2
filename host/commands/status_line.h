#pragma once

#include "base/stopwatch.h"

#include <string>

namespace tristim {

/// A line on stderr that says how far some work is. On a terminal it is rewritten in place ten times a second;
/// elsewhere a new line appears every ten seconds. Quiet ones show nothing.
class StatusLine {
  public:
    explicit StatusLine(bool quiet);

    /// Seconds since it was made.
    double elapsed() const { return stopwatch_.seconds(); }

    /// Whether it is time to show the line anew.
    bool due() const;
    void show(const std::string& line);

    /// Takes the line from the terminal; a last one, if there is any, stays.
    void finish(const std::string& last = {});

  private:
    bool quiet_;
    bool terminal_;
    Stopwatch stopwatch_;
    double last_shown_ = -1e9;
};

} // namespace tristim
