// Which rank gets which passes: host/mpi/batch_queue.h.

#include "mpi/batch_queue.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace tristim {
namespace {

constexpr double batch_seconds = 0.5;
constexpr double tick = 0.01; // s between two looks at messages

/// What a render by ranks of these speeds comes to.
struct Simulation {
    std::vector<std::uint64_t> passes; ///< of each rank
    std::vector<double> idle;          ///< s that each had nothing to do, before the end
    std::uint64_t batches = 0;
    double end = 0.0; ///< s
};

/// Ranks whose passes take so many seconds render so many passes, asking for more as JointRender does.
Simulation simulate(std::uint32_t passes, const std::vector<double>& pass_seconds) {
    const std::size_t ranks = pass_seconds.size();
    BatchQueue queue({0, passes}, ranks);
    Simulation result{std::vector<std::uint64_t>(ranks), std::vector<double>(ranks), 0, 0.0};
    std::vector<std::uint64_t> given(ranks);
    std::vector<double> progress(ranks); // passes done, with the part of the one under way
    std::vector<bool> asked(ranks);
    PassRanges all;
    double now = 0.0;
    for (; !queue.ended() && now < 1e4; now += tick) {
        for (std::size_t r = 0; r < ranks; ++r) {
            const auto done = static_cast<std::uint64_t>(progress[r]);
            const double queued = std::max(static_cast<double>(given[r]) - progress[r] - 1.0, 0.0);
            queue.report(r, done, done > 0 ? pass_seconds[r] : 0.0, now);
            asked[r] = asked[r] || queued * pass_seconds[r] < 0.1;
            if (asked[r]) {
                const PassRanges batch = queue.take(r, now, batch_seconds);
                all.add(batch);
                given[r] += batch.count();
                asked[r] = batch.empty();
                result.batches += batch.empty() ? 0 : 1;
            }
            if (static_cast<double>(given[r]) <= progress[r])
                result.idle[r] += tick;
            progress[r] = std::min(progress[r] + tick / pass_seconds[r] + 1e-12, static_cast<double>(given[r]));
        }
    }
    result.end = now;
    for (std::size_t r = 0; r < ranks; ++r)
        result.passes[r] = static_cast<std::uint64_t>(progress[r]);
    EXPECT_EQ(all, PassRanges(0, passes));
    EXPECT_EQ(queue.handed_out(), all);
    EXPECT_EQ(queue.done(), passes);
    return result;
}

TEST(BatchQueue, SharesFollowSpeed) {
    const Simulation three = simulate(7000, {0.01, 0.02, 0.04});
    // The shares of ranks that never wait and end together; the slowest may be a pass of its own late or early.
    const double slack = 0.04 + 4 * tick;
    EXPECT_NEAR(static_cast<double>(three.passes[0]), 4000.0, slack / 0.01);
    EXPECT_NEAR(static_cast<double>(three.passes[1]), 2000.0, slack / 0.02);
    EXPECT_NEAR(static_cast<double>(three.passes[2]), 1000.0, slack / 0.04);
    EXPECT_NEAR(three.end, 40.0, slack);
    // One batch for half a second at most, and some towards the end.
    EXPECT_LT(three.batches, 3 * 2 * 40 + 60);
}

TEST(BatchQueue, EqualRanksEndTogether) {
    for (const double pass_seconds : {0.02, 0.3, 5.0}) {
        const Simulation eight = simulate(400, std::vector<double>(8, pass_seconds));
        EXPECT_LE(eight.end, 50.0 * pass_seconds + pass_seconds + 4 * tick) << pass_seconds;
        for (const double idle : eight.idle)
            EXPECT_LE(idle, pass_seconds + 4 * tick) << pass_seconds;
    }
}

/// A rank a hundred times as slow as another must not begin a pass that the other would have done long before.
TEST(BatchQueue, SlowRanksDoNotDelayTheEnd) {
    const Simulation two = simulate(150, {0.1, 10.0});
    EXPECT_EQ(two.passes[1], 1U);
    EXPECT_NEAR(two.end, 14.9, 4 * tick); // with a second slow pass: 20
}

TEST(BatchQueue, ARankGetsOnePassUntilItsSpeedIsKnown) {
    BatchQueue queue({0, 100}, 1);
    EXPECT_EQ(queue.take(0, 0.0, 1.0), PassRanges(0, 1));
    EXPECT_TRUE(queue.take(0, 0.0, 1.0).empty());
    queue.report(0, 1, 0.1, 0.1);
    EXPECT_EQ(queue.take(0, 0.1, 1.0), PassRanges(1, 11));
}

TEST(BatchQueue, WhatAFailedRankLostIsHandedOutAnew) {
    BatchQueue queue({0, 5}, 2);
    EXPECT_EQ(queue.take(0, 0.0, 1.0), PassRanges(0, 1));
    EXPECT_EQ(queue.take(1, 0.0, 1.0), PassRanges(1, 2));
    queue.report(1, 1, 0.5, 1.0);
    EXPECT_EQ(queue.take(1, 1.0, 1.0), PassRanges(2, 3)); // half of what is left
    queue.failed(1, {2, 3});
    EXPECT_TRUE(queue.take(1, 1.0, 1.0).empty());
    EXPECT_EQ(queue.handed_out(), PassRanges(0, 2));
    queue.report(0, 1, 0.01, 1.0);
    std::uint64_t done = 1;
    while (!queue.ended()) {
        done += queue.take(0, 1.0, 1.0).count();
        queue.report(0, done, 0.01, 1.0);
    }
    EXPECT_EQ(queue.handed_out(), PassRanges(0, 5));
    EXPECT_EQ(queue.done(), 5U);
    // What was on its way to a rank as it failed comes back too, and the render does not end without it.
    BatchQueue late({0, 2}, 2);
    EXPECT_EQ(late.take(0, 0.0, 1.0).count(), 1U);
    EXPECT_EQ(late.take(1, 0.0, 1.0).count(), 1U);
    late.failed(1, {});
    late.report(0, 1, 0.1, 1.0);
    EXPECT_FALSE(late.ended());
    late.failed(1, {1, 2});
    EXPECT_EQ(late.take(0, 1.0, 1.0), PassRanges(1, 2));
    late.report(0, 2, 0.1, 1.0);
    EXPECT_TRUE(late.ended());
    // Nobody is left: the render is over with passes undone.
    BatchQueue alone({0, 5}, 1);
    EXPECT_EQ(alone.take(0, 0.0, 1.0).count(), 1U);
    alone.failed(0, {0, 1});
    EXPECT_TRUE(alone.ended());
    EXPECT_EQ(alone.done(), 0U);
}

} // namespace
} // namespace tristim
