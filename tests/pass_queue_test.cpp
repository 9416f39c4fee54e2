// Who gets which pass: host/render/pass_queue.h.

#include "render/pass_queue.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <set>

namespace tristim {
namespace {

/// What a render by workers of these speeds comes to.
struct Simulation {
    std::vector<std::uint64_t> passes; ///< of each worker
    std::vector<std::uint32_t> order;  ///< as they were taken
    double end = 0.0;                  ///< s
};

/// Workers whose passes take so many seconds render so many passes; worker `failing` fails after `good` of them, and
/// has lost the last two then.
Simulation simulate(const PassRanges& passes, const std::vector<double>& pass_seconds, std::size_t failing = 99,
                    std::uint64_t good = 0) {
    PassQueue queue(passes, pass_seconds.size());
    Simulation result{std::vector<std::uint64_t>(pass_seconds.size()), {}, 0.0};
    struct Running {
        double end;
        std::size_t worker;
        std::uint32_t pass;
        bool operator<(const Running& other) const { return end < other.end; }
    };
    std::multiset<Running> running;
    std::vector<std::uint32_t> of_failing;
    double now = 0.0;
    std::vector<bool> idle(pass_seconds.size(), true), failed(pass_seconds.size(), false);
    for (;;) {
        for (std::size_t w = 0; w < pass_seconds.size(); ++w) {
            if (!idle[w] || failed[w])
                continue;
            if (const auto pass = queue.take(w, now)) {
                idle[w] = false;
                result.order.push_back(*pass);
                running.insert({now + pass_seconds[w], w, *pass});
            }
        }
        if (running.empty())
            break;
        const Running first = *running.begin();
        running.erase(running.begin());
        now = result.end = first.end;
        idle[first.worker] = true;
        if (first.worker == failing) {
            of_failing.push_back(first.pass);
            if (of_failing.size() > good) {
                failed[failing] = true;
                queue.failed(failing, {of_failing.end() - 2, of_failing.end()});
                result.passes[failing] -= 1;
                continue;
            }
        }
        ++result.passes[first.worker];
        queue.done(first.worker, now);
    }
    EXPECT_TRUE(queue.empty() && !queue.busy());
    return result;
}

TEST(PassQueue, OneWorkerTakesAllInOrder) {
    const Simulation one = simulate({0, 5}, {0.1});
    EXPECT_EQ(one.order, (std::vector<std::uint32_t>{0, 1, 2, 3, 4}));
    EXPECT_EQ(simulate({0, 0}, {0.1}).order.size(), 0U);
}

TEST(PassQueue, OfSeveralRangesPassesComeInOrder) {
    const PassRanges ranges = PassRanges::parse("40:42,3:5,4294967293:4294967295");
    const Simulation one = simulate(ranges, {0.1});
    EXPECT_EQ(one.order, (std::vector<std::uint32_t>{3, 4, 40, 41, 4294967293U, 4294967294U}));
    const Simulation two = simulate(ranges, {0.1, 0.1});
    EXPECT_EQ(two.order, one.order);
    EXPECT_NEAR(two.end, 0.3, 1e-9);
}

TEST(PassQueue, SharesFollowSpeed) {
    const Simulation three = simulate({0, 700}, {0.1, 0.2, 0.4});
    EXPECT_NEAR(static_cast<double>(three.passes[0]), 400.0, 2.0);
    EXPECT_NEAR(static_cast<double>(three.passes[1]), 200.0, 2.0);
    EXPECT_NEAR(static_cast<double>(three.passes[2]), 100.0, 2.0);
    std::vector<std::uint32_t> order = three.order;
    EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
    EXPECT_EQ(order.size(), 700U);
    EXPECT_EQ(order.back(), 699U);
}

/// A worker a hundred times as slow as another must not begin a pass that the other would have done long before.
TEST(PassQueue, SlowWorkersDoNotDelayTheEnd) {
    const Simulation two = simulate({0, 150}, {0.1, 10.0});
    EXPECT_EQ(two.passes[1], 1U);
    EXPECT_NEAR(two.end, 14.9, 0.01); // with a second slow pass: 20
    // As quick as it can be: the slow one's first pass takes as long as all the others.
    EXPECT_NEAR(simulate({0, 20}, {0.1, 10.0}).end, 10.0, 1e-9);
}

TEST(PassQueue, EquallyFastWorkersDoNotWaitForEachOther) {
    const Simulation four = simulate({0, 9}, {1.0, 1.0, 1.0, 1.0});
    EXPECT_EQ(four.order.size(), 9U);
    EXPECT_NEAR(four.end, 3.0, 1e-9);
}

TEST(PassQueue, WhatAFailedWorkerLostIsDoneByTheOthers) {
    const Simulation two = simulate({0, 100}, {0.1, 0.1}, 1, 10);
    std::multiset<std::uint32_t> taken(two.order.begin(), two.order.end());
    EXPECT_EQ(taken.size(), 102U); // two of them twice
    EXPECT_EQ(std::set<std::uint32_t>(taken.begin(), taken.end()).size(), 100U);
    EXPECT_EQ(two.passes[0] + two.passes[1], 100U);
    EXPECT_EQ(two.passes[1], 9U);
    // No one is left: passes stay undone.
    PassQueue queue(PassRanges(0, 3), 1);
    EXPECT_EQ(queue.take(0, 0.0), 0U);
    queue.failed(0, {0});
    EXPECT_FALSE(queue.empty());
    EXPECT_FALSE(queue.busy());
    EXPECT_FALSE(queue.take(0, 1.0));
}

} // namespace
} // namespace tristim
