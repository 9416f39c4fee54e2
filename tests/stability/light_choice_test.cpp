// Choosing lights whose powers differ by many magnitudes.

#include "render/flat_scene.h"
#include "test_scenes.h"

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

namespace tristim::test {
namespace {

/// Point lights of these intensities, and a mesh, since a scene needs one.
FlatScene lights_of(const std::vector<double>& scales) {
    Scene scene;
    scene.camera = look_at({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 10.0);
    add_horizontal_square(scene, 1.0, 0.0, true, add_diffuse(scene, Spectrum::constant(0.5)));
    for (const double scale : scales) {
        Light light;
        light.kind = Light::Kind::Point;
        light.emission = Spectrum::constant(1.0);
        light.position = V3d(0, 0, 1);
        light.scale = scale;
        scene.lights.push_back(light);
    }
    return flatten_scene(scene, derive_effects(scene), 4, 4, {0, 0, 4, 4});
}

/// The share of the 2^24 numbers that choose_light leads to each light is the probability that its light is divided by,
/// exactly; no light that emits is without one, and none has more than its power's share but for those numbers.
void expect_fair(const std::vector<double>& scales) {
    const FlatScene flat = lights_of(scales);
    ASSERT_EQ(flat.light_cdf.size(), scales.size() + 1);
    EXPECT_EQ(flat.light_cdf.front(), 0.0F);
    EXPECT_EQ(flat.light_cdf.back(), 1.0F);
    double total = 0.0;
    for (const double scale : scales)
        total += scale;
    const double granted = static_cast<double>(scales.size()) * 0x1p-24;
    for (std::size_t i = 0; i < scales.size(); ++i) {
        const double numbers = (double{flat.light_cdf[i + 1]} - double{flat.light_cdf[i]}) * 0x1p24;
        const std::string at = fmt::format("light {} of intensity {}", i, scales[i]);
        ASSERT_EQ(numbers, std::floor(numbers)) << at;
        ASSERT_EQ(double{flat.lights[i].probability}, numbers * 0x1p-24) << at;
        ASSERT_EQ(numbers > 0.0, scales[i] > 0.0) << at;
        ASSERT_NEAR(flat.lights[i].probability, scales[i] / total, granted + 0x1p-24) << at;
    }
}

TEST(LightStability, EveryLightIsChosenWithTheProbabilityItIsDividedBy) {
    expect_fair({1.0});
    expect_fair({1.0, 1.0, 1.0});
    expect_fair({1e-12, 1.0, 1e-3, 1e9, 3e-8, 2.0});
    expect_fair({0.0, 1e-30, 0.0, 1e6, 0.0});
    std::vector<double> many(100000, 1e-6);
    many[1234] = 1e6;
    expect_fair(many);
}

} // namespace
} // namespace tristim::test
