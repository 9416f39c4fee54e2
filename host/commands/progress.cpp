#include "commands/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace tristim {

Progress::Progress(const RenderBudget& limits, int photons_per_pass, bool quiet, std::uint64_t earlier_passes)
    : limits_(limits), photons_per_pass_(photons_per_pass), earlier_passes_(earlier_passes), status_(quiet) {}

std::string Progress::line(std::uint64_t passes, const std::string& more, std::optional<double> other_end) const {
    const double seconds = std::max(elapsed(), 1e-9);
    const double photons = static_cast<double>(passes) * photons_per_pass_;
    double remaining = other_end.value_or(std::numeric_limits<double>::infinity());
    if (limits_.passes && passes > 0)
        remaining =
            std::min(remaining, seconds * static_cast<double>(*limits_.passes - passes) / static_cast<double>(passes));
    if (limits_.seconds)
        remaining = std::min(remaining, std::max(*limits_.seconds - seconds, 0.0));
    const std::string total = limits_.passes ? fmt::format("/{}", *limits_.passes + earlier_passes_) : "";
    return fmt::format("pass {}{}  photons {:.2f} M  {:.2f} Mphotons/s{}  elapsed {}  remaining {}",
                       passes + earlier_passes_, total, 1e-6 * photons, 1e-6 * photons / seconds,
                       more.empty() ? "" : "  " + more, format_duration(seconds),
                       remaining < std::numeric_limits<double>::infinity() ? format_duration(remaining) : "?");
}

void Progress::update(std::uint64_t passes, const std::string& more, std::optional<double> remaining) {
    if (status_.due())
        status_.show(line(passes, more, remaining));
}

void Progress::finish(std::uint64_t passes) {
    status_.finish(line(passes, {}, {}));
}

std::string format_duration(double seconds) {
    const auto whole = static_cast<long>(seconds + 0.5);
    if (whole >= 3600)
        return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
    return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

} // namespace tristim
