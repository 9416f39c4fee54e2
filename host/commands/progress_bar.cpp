#include "commands/progress_bar.h"

#include "commands/progress.h"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <unistd.h>

namespace tristim {
namespace {

constexpr int bar_width = 24; // characters

} // namespace

ProgressBar::ProgressBar(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {}

void ProgressBar::update(double done, double total, const std::string& what) {
    if (!done_before_)
        done_before_ = done;
    const double interval = terminal_ ? 0.1 : 10.0;
    const double now = stopwatch_.seconds();
    if (quiet_ || now - last_shown_ < interval)
        return;
    last_shown_ = now;
    const double share = total > 0.0 ? std::clamp(done / total, 0.0, 1.0) : 1.0;
    const double here = done - *done_before_;
    const std::string remaining =
        here > 0.0 ? format_duration(now / here * std::max(total - done, 0.0)) : std::string("?");
    const auto filled = static_cast<std::size_t>(share * bar_width);
    fmt::print(stderr, "{}[{}{}] {:3.0f} %  {}  elapsed {}  remaining {}{}", terminal_ ? "\r\033[K" : "",
               std::string(filled, '#'), std::string(bar_width - filled, '.'), 100.0 * share, what,
               format_duration(now), remaining, terminal_ ? "" : "\n");
    std::fflush(stderr);
}

void ProgressBar::finish() {
    if (!quiet_ && terminal_)
        fmt::print(stderr, "\r\033[K");
}

} // namespace tristim
