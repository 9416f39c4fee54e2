// --method auto: what the trials measure, and what follows from it.
#include "kernel_harness.h"
#include "render/choose_method.h"
#include "render/renderer.h"
#include "test_names.h"
#include "test_scenes.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace tristim::test {
namespace {

MethodChoice choose(const Scene& scene, const RenderOptions& options, const RenderBudget& budget) {
    return choose_method(std::make_shared<const DeviceScene>(scene, options, test_device()), options, test_device(),
                         budget);
}

Scene scene_of(const std::string& name) {
    return load_scene(TRISTIM_SOURCE_DIR "/meshes/" + name + "/scene.pbrt");
}

/// A copper mirror in a white environment, seen at one angle: only wavelengths vary.
Scene mirror() {
    Scene scene;
    scene.camera = look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 0.001);
    scene.lights.push_back(environment(Spectrum::named("stdillum-D65")));
    const int copper = add_conductor(scene, Spectrum::named("metal-Cu-eta"), Spectrum::named("metal-Cu-k"));
    add_horizontal_square(scene, 1.0, 0.0, true, copper);
    return scene;
}

/// A grey floor under the same environment, without photons: pixels are independent of each other.
Scene floor_alone() {
    Scene scene;
    scene.camera = look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 20.0);
    scene.lights.push_back(environment(Spectrum::named("stdillum-D65")));
    // Above the floor, so that half of the light samples miss.
    const int grey = add_diffuse(scene, Spectrum::constant(0.5));
    add_horizontal_square(scene, 5.0, 0.0, true, grey);
    add_box(scene, {1.5, -5, 0.5}, {2.5, 5, 2}, false, grey);
    return scene;
}

using Pixels = std::vector<std::array<float, 3>>;

Pixels pass_of(Renderer& renderer, const PassSeeds& seeds) {
    renderer.reset();
    renderer.render_pass(seeds);
    return xyz_image(renderer.film()).xyz;
}

double half_squared_difference(const Pixels& a, const Pixels& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            sum += 0.5 * std::pow(double{a[i][c]} - b[i][c], 2) / 3.0;
    }
    return sum / static_cast<double>(a.size());
}

TEST(ChooseMethod, ErrorOfIndependentPathsAndStratifiedWavelengths) {
    const MethodTrial trial{parse_method("hero:4"), 9.0, 16.0, 0.01};
    EXPECT_DOUBLE_EQ(trial.error_after(1.0, false), 5.0);
    EXPECT_DOUBLE_EQ(trial.error_after(4.0, false), std::sqrt(9.0 / 4.0 + 16.0 / 16.0));
    EXPECT_DOUBLE_EQ(trial.error_after(4.0, true), 2.5);
    EXPECT_DOUBLE_EQ(trial.error_after(0.3, false), 5.0) << "less than a pass is a pass";
}

/// Where paths do not vary, the variance is all of the wavelengths: that of the two passes the trial saw.
TEST(ChooseMethod, AMirrorsVarianceIsThatOfItsWavelengths) {
    const Scene scene = mirror();
    RenderOptions options = small_render("illuminant-mixture:8", 4, 4, 1, 0.1, 4);
    options.seed = 5;
    Renderer renderer(scene, options, test_device());
    const double expected = half_squared_difference(pass_of(renderer, {0, 77, 0, 5}), pass_of(renderer, {1, 77, 0, 5}));
    options.auto_method = true;
    const MethodChoice choice = choose(scene, options, {100, {}});
    const MethodTrial& trial = choice.trials.front();
    EXPECT_EQ(trial.method.name(), "illuminant-mixture:8");
    EXPECT_GT(expected, 0.0);
    // Images are floats near 1; their differences carry a rounding each.
    EXPECT_NEAR(trial.wavelength_variance, expected, 1e-3 * expected);
    EXPECT_LT(trial.path_variance, 1e-6 * expected);
}

/// The trial's estimate is one of those that other paths give.
TEST(ChooseMethod, PathVarianceIsThatOfPassesWithTheSameWavelengths) {
    const Scene scene = floor_alone();
    RenderOptions options = small_render("illuminant-mixture:8", 32, 32, 1, 0.1, 4);
    options.seed = 9;
    Renderer renderer(scene, options, test_device());
    kernel_test::Moments estimates;
    for (std::uint32_t pair = 0; pair < 24; ++pair) {
        double estimate = 0.0;
        for (std::uint32_t pass = 0; pass < 2; ++pass)
            estimate += 0.5 * half_squared_difference(pass_of(renderer, {pass, 1000 + 2 * pair, 0, 9}),
                                                      pass_of(renderer, {pass, 1001 + 2 * pair, 0, 9}));
        estimates.add(estimate);
    }
    options.auto_method = true;
    const MethodChoice choice = choose(scene, options, {100, {}});
    const double deviation = estimates.standard_error() * std::sqrt(24.0);
    EXPECT_LT(deviation, 0.2 * estimates.mean()) << "too noisy to tell anything";
    // A t of 23 degrees of freedom exceeds 4.5 in one of six thousand seeds.
    EXPECT_NEAR(choice.trials.front().path_variance, estimates.mean(), 4.5 * deviation);
}

std::vector<std::string> tried(const MethodChoice& choice) {
    std::vector<std::string> names;
    for (const MethodTrial& trial : choice.trials)
        names.push_back(trial.method.name());
    return names;
}

class EveryScene : public testing::TestWithParam<std::string> {};

/// Whatever the scene, what is chosen is unbiased and predicts the least error of what was tried, but for the 2 % that
/// a later one must be better by; one wavelength is tried where surfaces disperse, and nowhere else.
TEST_P(EveryScene, ChoosesTheLeastPredictedErrorOfUnbiasedMethods) {
    const Scene scene = load_scene(TRISTIM_SOURCE_DIR "/meshes/" + GetParam());
    RenderOptions options = small_render("illuminant-mixture:4", 16, 16, 1024, 0.2, 8);
    options.auto_method = true;
    const double seconds = 300.0; // so long that all trials are affordable
    const MethodChoice choice = choose(scene, options, {{}, seconds});
    EXPECT_EQ(choice.budget_seconds, seconds);
    const std::vector<std::string> names = tried(choice);
    const auto error = [&](const MethodTrial& trial) { return trial.error_after(seconds / trial.pass_seconds, false); };
    const MethodTrial* best = &choice.trials.front();
    for (const MethodTrial& trial : choice.trials) {
        if (error(trial) < 0.98 * error(*best))
            best = &trial;
    }
    EXPECT_EQ(choice.method.name(), best->method.name());
    EXPECT_EQ(names.front(), "illuminant-mixture:8");
    EXPECT_GE(names.size(), 2U);
    double total = 0.0;
    for (const MethodTrial& trial : choice.trials) {
        EXPECT_TRUE(trial.method.unbiased()) << trial.method.name();
        EXPECT_GT(trial.pass_seconds, 0.0);
        EXPECT_EQ(trial.predicted_error, error(trial));
        total += (trial.method.wavelengths() == 1 ? 8.0 : 4.0) * trial.pass_seconds;
    }
    EXPECT_GE(choice.seconds, total) << "each trial is four passes, or eight";
    const bool one = std::find(names.begin(), names.end(), "illuminant-mixture:1") != names.end();
    EXPECT_EQ(one, derive_effects(scene).dispersion);
    const std::string text = describe(choice);
    for (const std::string& name : names)
        EXPECT_NE(text.find(name), std::string::npos) << text;
    EXPECT_NE(text.find("chose " + choice.method.name()), std::string::npos) << text;
}

INSTANTIATE_TEST_SUITE_P(Scenes, EveryScene,
                         testing::Values("dispersion/scene.pbrt", "box/scene.pbrt", "interference-areas/a.pbrt"),
                         [](const testing::TestParamInfo<std::string>& scene) { return test_name(scene.param); });

/// Caustics of dispersive glass seen through it: light and eye must keep the same wavelength to meet, and the fewer
/// there are, the oftener they do. On the prism's screen nothing has to meet, and several wavelengths average.
TEST(ChooseMethod, OneWavelengthHasLessPathVarianceBehindDispersiveGlassAndMoreOnThePrismsScreen) {
    if (!long_tests())
        GTEST_SKIP() << "set TRISTIM_LONG_TESTS=1";
    const auto variances = [](const std::string& name, double radius) {
        RenderOptions options = small_render("illuminant-mixture:4", 64, 64, 16384, radius, 12);
        options.auto_method = true;
        const MethodChoice choice = choose(scene_of(name), options, {500, {}});
        return std::pair(choice.trials[0].path_variance, choice.trials[1].path_variance);
    };
    const auto [eight, one] = variances("dispersion", 0.12);
    EXPECT_LT(one, eight);
    const auto [eight_on_screen, one_on_screen] = variances("prism", 0.05);
    EXPECT_GT(one_on_screen, eight_on_screen);
}

TEST(ChooseMethod, RendererRefusesAMethodThatIsStillToBeChosen) {
    RenderOptions options = small_render("illuminant-mixture:4", 4, 4, 1, 0.1, 4);
    options.auto_method = true;
    EXPECT_ANY_THROW(Renderer(mirror(), options, test_device()));
}

} // namespace
} // namespace tristim::test
