#include "render/radius_schedule.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tristim {
namespace {

/// Knaus & Zwicker 2011, equation 15, multiplied out pass by pass.
TEST(RadiusSchedule, IsTheRunningProduct) {
    for (const double alpha : {0.1, 0.5, 2.0 / 3.0, 0.9, 1.0}) {
        double squared = 1.0; // r² of the pass over that of the first
        for (std::uint32_t pass = 0; pass < 100000; ++pass) {
            // 1e5 roundings of the product, and log Γ near 1e6 with an error of some units of 1e6 in exp's argument.
            ASSERT_NEAR(radius_scale(pass, alpha) / std::sqrt(squared), 1.0, 1e-8)
                << "pass " << pass << ", alpha " << alpha;
            const double i = pass + 1.0;
            squared *= (i + alpha) / (i + 1.0);
        }
    }
}

TEST(RadiusSchedule, StartsAtOneAndShrinksAsItsExponentSays) {
    EXPECT_NEAR(radius_scale(0), 1.0, 1e-15);
    // r² falls as i^(α-1): the ratio of Γ functions is i^(α-1) (1 + O(1/i)).
    const double slope = std::log(radius_scale(4000000) / radius_scale(1000000)) / std::log(4.0);
    EXPECT_NEAR(slope, 0.5 * (radius_alpha - 1.0), 1e-6);
    EXPECT_GT(radius_scale(4294967294U), 0.0);
}

} // namespace
} // namespace tristim
