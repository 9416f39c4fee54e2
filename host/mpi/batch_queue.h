#pragma once

#include "render/pass_ranges.h"

#include <cstdint>
#include <vector>

namespace tristim {

/// Hands out the passes of an image in batches to ranks of different speed: so many at a time that ranks seldom ask,
/// fewer towards the end, so that all end together. Times are in seconds from any start.
class BatchQueue {
  public:
    BatchQueue(PassRanges passes, std::size_t ranks);

    /// What a rank has told of itself: the passes that it has done in all, and the time that it takes for one; 0 if it
    /// does not know yet.
    void report(std::size_t rank, std::uint64_t done, double pass_seconds, double now);

    /// Passes for a rank that is about to need some: as many as it can do in `batch_seconds`, one to begin with. None
    /// if none is left, the rank is still to tell how fast it is or the others, at the speed that they have shown, will
    /// have done all that are left before it could do one; it may ask again.
    PassRanges take(std::size_t rank, double now, double batch_seconds);

    /// The rank takes no more, and these of its passes are handed out anew. It may hand back more later, such as had
    /// been on their way to it.
    void failed(std::size_t rank, const PassRanges& lost);

    /// The passes that ranks hold: those done and those to be done.
    const PassRanges& handed_out() const { return handed_out_; }
    std::uint64_t done() const { return done_; }

    /// Whether all passes are done, or no rank is left to do them and all have handed back what they lost.
    bool ended() const;

  private:
    struct Rank {
        bool failed = false;
        std::uint64_t handed_out = 0;
        std::uint64_t done = 0;
        double pass_seconds = 0.0;
        double told_at = 0.0;
        double speed() const { return failed || pass_seconds <= 0.0 ? 0.0 : 1.0 / pass_seconds; }
    };

    double free_at(const Rank& rank, double now) const;
    bool others_are_quicker(std::size_t rank, double now) const;

    PassRanges left_;
    std::uint64_t left_count_;
    PassRanges handed_out_;
    std::uint64_t done_ = 0;
    double speed_ = 0.0; ///< passes a second of all ranks
    std::vector<Rank> ranks_;
};

} // namespace tristim
