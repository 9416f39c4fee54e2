#include "mpi/batch_queue.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tristim {
namespace {

/// The part of what is left, by its speed, that a rank takes at once: guided self-scheduling (Polychronopoulos & Kuck
/// 1987, "Guided Self-Scheduling", section 3) hands out all of it and relies on equal passes; half of it leaves room
/// for speeds that change.
constexpr double share_of_rest = 0.5;

} // namespace

BatchQueue::BatchQueue(PassRanges passes, std::size_t ranks)
    : left_(std::move(passes)), left_count_(left_.count()), ranks_(ranks) {}

void BatchQueue::report(std::size_t rank, std::uint64_t done, double pass_seconds, double now) {
    Rank& teller = ranks_[rank];
    done_ += done - teller.done;
    speed_ -= teller.speed();
    teller.done = done;
    teller.pass_seconds = pass_seconds;
    teller.told_at = now;
    speed_ += teller.speed();
}

/// When a rank will have done what it has.
double BatchQueue::free_at(const Rank& rank, double now) const {
    return std::max(now, rank.told_at + static_cast<double>(rank.handed_out - rank.done) * rank.pass_seconds);
}

/// Whether the others will have done all that is left before this rank could do one pass of it.
bool BatchQueue::others_are_quicker(std::size_t rank, double now) const {
    const double until = free_at(ranks_[rank], now) + ranks_[rank].pass_seconds;
    const auto left = static_cast<double>(left_count_);
    if (left > speed_ * (until - now))
        return false;
    double count = 0.0;
    for (std::size_t i = 0; i < ranks_.size(); ++i) {
        const Rank& other = ranks_[i];
        if (i != rank && other.speed() > 0.0)
            count += std::max(std::ceil((until - free_at(other, now)) * other.speed()) - 1.0, 0.0);
    }
    return count >= left;
}

PassRanges BatchQueue::take(std::size_t rank, double now, double batch_seconds) {
    Rank& taker = ranks_[rank];
    if (left_count_ == 0 || taker.failed)
        return {};
    double count = 1.0;
    if (taker.speed() > 0.0) {
        if (others_are_quicker(rank, now))
            return {};
        const double share = static_cast<double>(left_count_) * taker.speed() / speed_;
        count = std::max(std::min(batch_seconds * taker.speed(), share_of_rest * share), 1.0);
    } else if (taker.handed_out > taker.done) {
        return {};
    }
    const PassRanges batch = left_.take(static_cast<std::uint64_t>(count));
    left_count_ -= batch.count();
    taker.handed_out += batch.count();
    handed_out_.add(batch);
    return batch;
}

void BatchQueue::failed(std::size_t rank, const PassRanges& lost) {
    Rank& taker = ranks_[rank];
    speed_ -= taker.speed();
    taker.failed = true;
    taker.handed_out -= lost.count();
    left_.add(lost);
    left_count_ += lost.count();
    handed_out_ = handed_out_.without(lost);
}

bool BatchQueue::ended() const {
    // A rank that has failed still hands back what was on its way to it.
    if (std::any_of(ranks_.begin(), ranks_.end(), [](const Rank& rank) { return rank.handed_out > rank.done; }))
        return false;
    return left_count_ == 0 || std::all_of(ranks_.begin(), ranks_.end(), [](const Rank& rank) { return rank.failed; });
}

} // namespace tristim
