#include "render/pass_queue.h"

#include <algorithm>
#include <cmath>

namespace tristim {

std::uint64_t PassQueue::left() const {
    std::uint64_t count = returned_.size();
    for (std::size_t i = current_; i < ranges_.size(); ++i)
        count += ranges_[i].end - ranges_[i].begin;
    return count;
}

/// How many passes the other workers will have done before `until`, beyond those under way.
double PassQueue::others_can_do(std::size_t worker, double now, double until) const {
    double count = 0.0;
    for (std::size_t i = 0; i < workers_.size(); ++i) {
        const Worker& other = workers_[i];
        if (i == worker || other.failed || other.passes == 0)
            continue;
        const double free = other.began ? std::max(now, *other.began + other.pass_seconds()) : now;
        count += std::max(std::ceil((until - free) / other.pass_seconds()) - 1.0, 0.0);
    }
    return count;
}

std::optional<std::uint32_t> PassQueue::take(std::size_t worker, double now) {
    Worker& taker = workers_[worker];
    if (left() == 0 || taker.failed)
        return {};
    if (taker.passes > 0 && others_can_do(worker, now, now + taker.pass_seconds()) >= static_cast<double>(left()))
        return {};
    taker.began = now;
    if (returned_.empty()) {
        PassRanges::Range& range = ranges_[current_];
        const std::uint32_t pass = range.begin++;
        if (range.begin == range.end)
            ++current_;
        return pass;
    }
    const std::uint32_t pass = returned_.back();
    returned_.pop_back();
    return pass;
}

void PassQueue::done(std::size_t worker, double now) {
    Worker& w = workers_[worker];
    w.seconds += std::max(now - *w.began, 1e-9);
    ++w.passes;
    w.began.reset();
}

void PassQueue::failed(std::size_t worker, const std::vector<std::uint32_t>& lost) {
    workers_[worker].failed = true;
    workers_[worker].began.reset();
    returned_.insert(returned_.end(), lost.rbegin(), lost.rend());
}

void PassQueue::add(const PassRanges& passes) {
    ranges_.erase(ranges_.begin(), ranges_.begin() + static_cast<std::ptrdiff_t>(current_));
    current_ = 0;
    ranges_.insert(ranges_.end(), passes.ranges().begin(), passes.ranges().end());
}

double PassQueue::pass_seconds() const {
    double speed = 0.0;
    for (const Worker& worker : workers_) {
        if (!worker.failed && worker.passes > 0)
            speed += 1.0 / worker.pass_seconds();
    }
    return speed > 0.0 ? 1.0 / speed : 0.0;
}

bool PassQueue::busy() const {
    return std::any_of(workers_.begin(), workers_.end(), [](const Worker& w) { return w.began.has_value(); });
}

} // namespace tristim
