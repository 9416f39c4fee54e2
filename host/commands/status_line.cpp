#include "commands/status_line.h"

#include "base/tell.h"

#include <fmt/format.h>
#include <unistd.h>

namespace tristim {
namespace {

constexpr const char* clear_line = "\r\033[K";

} // namespace

StatusLine::StatusLine(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {}

bool StatusLine::due() const {
    const double interval = terminal_ ? 0.1 : 10.0;
    return !quiet_ && elapsed() - last_shown_ >= interval;
}

void StatusLine::show(const std::string& line) {
    last_shown_ = elapsed();
    if (terminal_)
        tell("{}{}", clear_line, line);
    else
        tell("{}\n", line);
}

void StatusLine::finish(const std::string& last) {
    if (quiet_)
        return;
    if (terminal_)
        tell("{}", clear_line);
    if (!last.empty())
        tell("{}\n", last);
}

} // namespace tristim
