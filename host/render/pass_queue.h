#pragma once

#include "render/pass_ranges.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace tristim {

/// Hands out the numbers of passes, ascending, to workers of different speed. Times are in seconds from any
/// start. Not safe for threads by itself.
class PassQueue {
  public:
    /// These passes.
    PassQueue(const PassRanges& passes, std::size_t workers) : ranges_(passes.ranges()), workers_(workers) {}

    /// More passes, to be done after those that are there.
    void add(const PassRanges& passes);

    /// The pass that an idle worker is to begin now; none if no pass is left or the others, at the speed that they have
    /// shown, will have done all that are left before it could do one.
    std::optional<std::uint32_t> take(std::size_t worker, double now);

    /// The worker has done the pass that it took.
    void done(std::size_t worker, double now);

    /// The worker takes no more; what it has lost, the pass that it took among it, is handed out anew.
    void failed(std::size_t worker, const std::vector<std::uint32_t>& lost);

    /// Whether every pass is done, unless one fails that is under way.
    bool empty() const { return left() == 0; }
    bool busy() const;

    /// Passes that no one has begun yet.
    std::uint64_t left() const;

    /// What a pass takes the workers together, at the speed that they have shown; 0 before any has.
    double pass_seconds() const;

  private:
    struct Worker {
        bool failed = false;
        std::optional<double> began; ///< the pass that is under way
        double seconds = 0.0;        ///< of all that it has done
        std::uint64_t passes = 0;
        double pass_seconds() const { return seconds / static_cast<double>(passes); }
    };

    double others_can_do(std::size_t worker, double now, double until) const;

    std::vector<PassRanges::Range> ranges_;
    std::size_t current_ = 0; ///< of the ranges; `begin` of it is the next pass
    std::vector<std::uint32_t> returned_;
    std::vector<Worker> workers_;
};

} // namespace tristim
