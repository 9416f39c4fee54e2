#include "commands/progress_bar.h"

#include "commands/progress.h"

#include <algorithm>
#include <fmt/format.h>

namespace tristim {
namespace {

constexpr int bar_width = 24; // characters

} // namespace

void ProgressBar::update(double done, double total, const std::string& what) {
    if (!done_before_)
        done_before_ = done;
    if (!status_.due())
        return;
    const double share = total > 0.0 ? std::clamp(done / total, 0.0, 1.0) : 1.0;
    const double elapsed = status_.elapsed();
    const double here = done - *done_before_;
    const std::string remaining =
        here > 0.0 ? format_duration(elapsed / here * std::max(total - done, 0.0)) : std::string("?");
    const auto filled = static_cast<std::size_t>(share * bar_width);
    status_.show(fmt::format("[{}{}] {:3.0f} %  {}  elapsed {}  remaining {}", std::string(filled, '#'),
                             std::string(bar_width - filled, '.'), 100.0 * share, what, format_duration(elapsed),
                             remaining));
}

} // namespace tristim
