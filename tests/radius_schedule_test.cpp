#include "render/radius_schedule.h"

#include "render/renderer.h"
#include "test_scenes.h"

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

/// The radius with which a pass looks for photons.
double radius_of_pass(const RenderOptions& options, std::uint32_t pass) {
    Scene scene;
    scene.camera = test::look_at({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 30.0);
    test::add_horizontal_square(scene, 5.0, 0.0, true, test::add_diffuse(scene, Spectrum::constant(0.5)));
    scene.lights.push_back(test::environment(Spectrum::constant(1.0)));
    Renderer renderer(scene, options, test::test_device());
    renderer.render_pass(pass);
    return renderer.visible_points().front().radius;
}

TEST(RadiusOptions, FactorAndAlphaReachTheVisiblePoints) {
    constexpr std::uint32_t pass = 9;
    constexpr double rounding = 1e-6; // of two products in float
    RenderOptions options = test::small_render("tristimulus:1", 4, 4, 64, 0.25, 4);
    options.radius_factor = 2.0;
    EXPECT_NEAR(radius_of_pass(options, 0), 0.5, rounding);
    for (const double alpha : {0.3, radius_alpha, 0.9}) {
        options.alpha = alpha;
        EXPECT_NEAR(radius_of_pass(options, pass), 0.5 * radius_scale(pass, alpha), rounding) << alpha;
    }
    // A measured radius takes the factor too.
    options.radius.reset();
    const double twice = radius_of_pass(options, 0);
    options.radius_factor = 1.0;
    EXPECT_NEAR(radius_of_pass(options, 0), 0.5 * twice, rounding * twice);
}

} // namespace
} // namespace tristim
