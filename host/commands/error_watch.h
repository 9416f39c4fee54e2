#pragma once

#include "base/stopwatch.h"
#include "render/error_trend.h"
#include "render/pass_renderer.h"

#include <optional>
#include <string>

namespace tristim {

/// Estimates the error of a render while it goes on, and says when it is small enough.
class ErrorWatch {
  public:
    /// Without a target it does nothing.
    ErrorWatch(std::optional<double> target, int width) : target_(target), width_(width) {}

    /// `passes` are all that are in the image by now. Estimates when these are a quarter more than last time or the
    /// trend says that the target is reached, unless that would take more than a hundredth of the time. Whether the
    /// last estimate fell under the target.
    bool reached(PassRenderer& renderer, std::uint64_t passes);

    /// Seconds to the target after `passes`, of which `here` took `seconds`; none while it cannot be told.
    std::optional<double> remaining(std::uint64_t passes, std::uint64_t here, double seconds) const;

    /// "error 0.012 of 0.005", or empty before the first estimate.
    std::string text() const;

  private:
    std::optional<double> target_;
    int width_;
    ErrorTrend trend_;
    std::optional<double> rmse_;     ///< last estimated
    std::uint64_t estimated_at_ = 0; ///< passes
    bool requested_ = false;
    Stopwatch stopwatch_;
    double finished_at_ = 0.0; ///< seconds, of the last estimate
    double cost_ = 0.0;        ///< seconds that it took
};

} // namespace tristim
