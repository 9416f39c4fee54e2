#pragma once

#include "render/error_estimate.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace tristim {

/// How the error of a render falls with its passes, as its own estimates tell.
class ErrorTrend {
  public:
    /// An estimate after more passes than the ones before.
    void add(std::uint64_t passes, double rmse) { points_.push_back({passes, rmse}); }

    /// The passes after which the error will be `target`, by a straight line through log(error) over log(passes), least
    /// squares over the last factor of eight in passes. None while there are fewer than three estimates, or where the
    /// error does not fall.
    std::optional<double> passes_to(double target) const;

  private:
    struct Point {
        std::uint64_t passes;
        double rmse;
    };
    std::vector<Point> points_;
};

} // namespace tristim
