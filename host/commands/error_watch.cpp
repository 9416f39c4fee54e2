#include "commands/error_watch.h"

#include <algorithm>
#include <fmt/format.h>

namespace tristim {
namespace {

/// Fewer show four sizes of blocks or less, too few to tell how the noise falls.
constexpr std::uint64_t fewest_passes = 16;
/// Reading the sums from the devices costs about as much again.
constexpr double seconds_per_estimating_second = 200.0;

} // namespace

bool ErrorWatch::reached(PassRenderer& renderer, std::uint64_t passes) {
    if (!target_)
        return false;
    if (!requested_) {
        const std::optional<double> predicted = trend_.passes_to(*target_);
        const bool much_done = passes >= std::max(fewest_passes, estimated_at_ + estimated_at_ / 4);
        const bool near = predicted && static_cast<double>(passes) >= *predicted && passes > estimated_at_;
        if (!(much_done || near) || stopwatch_.seconds() - finished_at_ < seconds_per_estimating_second * cost_)
            return false;
        renderer.request_sums();
        requested_ = true;
    }
    const Stopwatch estimating;
    const std::optional<RenderSums> sums = renderer.requested_sums();
    if (!sums)
        return false;
    requested_ = false;
    const std::uint64_t count = sums->passes.count();
    if (count < fewest_passes || count <= estimated_at_)
        return false;
    rmse_ = estimate_error(*sums, width_).rmse;
    trend_.add(count, *rmse_);
    estimated_at_ = count;
    finished_at_ = stopwatch_.seconds();
    cost_ = estimating.seconds();
    return *rmse_ < *target_;
}

std::optional<double> ErrorWatch::remaining(std::uint64_t passes, std::uint64_t here, double seconds) const {
    const std::optional<double> needed = target_ ? trend_.passes_to(*target_) : std::nullopt;
    if (!needed || here == 0)
        return {};
    return std::max(*needed - static_cast<double>(passes), 0.0) * seconds / static_cast<double>(here);
}

std::string ErrorWatch::text() const {
    return rmse_ ? fmt::format("error {:.2g} of {:.2g}", *rmse_, *target_) : "";
}

} // namespace tristim
