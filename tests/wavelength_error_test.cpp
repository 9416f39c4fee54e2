// What the stratified sequence and the light's spectrum gain over the paper's random wavelengths, where nothing but
// wavelengths is random: mirrors under a constant light (bench/scenes/).
#include "bench/wavelength_error.h"
#include "bench_scenes.h"
#include "child_process.h"
#include "scene/scene.h"
#include "test_names.h"
#include "test_scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tristim::test {
namespace {

std::string flat_scene(const std::string& name) {
    return TRISTIM_SOURCE_DIR "/bench/scenes/" + name + ".pbrt";
}

class MirrorScene {
  public:
    explicit MirrorScene(const std::string& name)
        : scene_(load_scene(flat_scene(name))), options_(options_from_scene(scene_.settings)),
          on_device_(std::make_shared<const DeviceScene>(scene_, options_, test_device())) {}

    RenderOptions options(const std::string& method, bool random) const {
        RenderOptions options = options_;
        options.method = parse_method(method);
        options.random_sequence = random;
        return options;
    }

    ExactImage exact(std::uint64_t passes) const { return exact_image(on_device_, options_, test_device(), passes); }

    double noise_of_paths(const std::string& method) const {
        return geometric_noise(on_device_, options(method, false), test_device(), 16);
    }

    WavelengthCurve error(const std::string& method, bool random, const XyzImage& exact, std::uint64_t passes,
                          int repeats) const {
        return wavelength_error(on_device_, options(method, random), test_device(), exact, passes, repeats);
    }

    /// The RMSE to be expected after one pass of random wavelengths, from the spread over so many passes.
    double random_error(const std::string& method, std::uint32_t passes) const {
        Renderer renderer(on_device_, options(method, true), test_device());
        for (std::uint32_t pass = 0; pass < passes; ++pass)
            renderer.render_pass(pass);
        const FilmImage film = renderer.film(); // with the variance of the mean
        double sum = 0.0;
        for (const auto& pixel : film.variance)
            sum += static_cast<double>(pixel[0]) + pixel[1] + pixel[2];
        return std::sqrt(passes * sum / (3.0 * static_cast<double>(film.variance.size())));
    }

  private:
    Scene scene_;
    RenderOptions options_;
    std::shared_ptr<const DeviceScene> on_device_;
};

struct Bound {
    const char* scene;
    const char* method; ///< stratified
    double gain;        ///< over tristimulus:1 random
    int repeats;
};

class WavelengthError : public testing::TestWithParam<Bound> {};

TEST_P(WavelengthError, IsManyTimesBelowThatOfRandomWavelengths) {
    if (std::string(GetParam().scene) != "mercury-lines" && !long_tests())
        GTEST_SKIP() << "set TRISTIM_LONG_TESTS=1";
    constexpr std::uint32_t passes = 2048;
    const Bound& bound = GetParam();
    const MirrorScene scene(bound.scene);
    const ExactImage exact = scene.exact(512);
    const WavelengthCurve curve = scene.error(bound.method, false, exact.image, passes, bound.repeats);
    const double random = scene.random_error("tristimulus:1", 2 * passes) / std::sqrt(passes);
    const double gain = random / curve.rmse.back();
    const double sigma = gain * curve.standard_error.back() / curve.rmse.back();
    RecordProperty("gain", std::to_string(gain));
    RecordProperty("standard_error", std::to_string(sigma));
    EXPECT_LT(exact.error, 0.05 * curve.rmse.back());
    EXPECT_EQ(scene.noise_of_paths(bound.method), 0.0);
    EXPECT_GE(gain - 2.0 * sigma, bound.gain) << random << " over " << curve.rmse.back();
}

INSTANTIATE_TEST_SUITE_P(Lights, WavelengthError,
                         testing::Values(Bound{"mercury-lines", "illuminant:1", 100.0, 6},
                                         Bound{"f12", "illuminant:1", 50.0, 6}, Bound{"d65", "tristimulus:1", 10.0, 6}),
                         [](const auto& bound) { return test_name(bound.param.scene); });

/// The passes of --sequence random are independent: the mean square of the error after n of them is the variance of one
/// over n. Of R repeats it scatters by √(2/R) to √(2/3R), as the three channels go together or not, and its root by
/// half of that. The spread over 4,096 passes is known far better.
TEST(WavelengthErrorInstrument, FindsTheErrorThatTheVarianceOfRandomPassesTells) {
    constexpr int repeats = 128;
    const double most = 0.5 * std::sqrt(2.0 / repeats), least = most / std::sqrt(3.0);
    const MirrorScene scene("d65");
    const WavelengthCurve curve = scene.error("tristimulus:1", true, scene.exact(16).image, 32, repeats);
    const double expected = scene.random_error("tristimulus:1", 4096);
    ASSERT_EQ(curve.passes, (std::vector<std::uint64_t>{1, 2, 4, 8, 16, 32}));
    for (const std::size_t i : {4U, 5U}) {
        const double rmse = expected / std::sqrt(static_cast<double>(curve.passes[i]));
        EXPECT_NEAR(curve.rmse[i], rmse, 4.0 * most * rmse) << curve.passes[i] << " passes";
        EXPECT_GT(curve.standard_error[i], 0.7 * least * rmse) << curve.passes[i] << " passes";
        EXPECT_LT(curve.standard_error[i], 1.4 * most * rmse) << curve.passes[i] << " passes";
    }
}

TEST(WavelengthErrorInstrument, SeesTheNoiseOfPaths) {
    const Scene scene = lattice(2, [](int, int) { return 0.25; });
    const RenderOptions options = small_render("tristimulus:1", 2, 2, 1, 1.0, 3);
    const auto on_device = std::make_shared<const DeviceScene>(scene, options, test_device());
    EXPECT_GT(geometric_noise(on_device, options, test_device(), 3), 0.0);
}

TEST(WavelengthErrorInstrument, EndsAtTheLastPass) {
    EXPECT_EQ(doublings(1), (std::vector<std::uint64_t>{1}));
    EXPECT_EQ(doublings(8), (std::vector<std::uint64_t>{1, 2, 4, 8}));
    EXPECT_EQ(doublings(11), (std::vector<std::uint64_t>{1, 2, 4, 8, 11}));
}

TEST(BenchWavelengths, PutsTheBaselineFirst) {
    const ChildResult result =
        run_tristim({"bench-wavelengths", flat_scene("f12"), "--methods=illuminant:1,tristimulus:1@random,rgb",
                     "--passes=5", "--repeats=2", "--json", "--quiet"});
    ASSERT_EQ(result.exit_code, 0) << result.standard_error;
    const auto json = nlohmann::json::parse(result.standard_output);
    ASSERT_EQ(json.size(), 1U);
    EXPECT_EQ(json[0]["name"], "f12");
    std::vector<std::string> methods;
    for (const auto& method : json[0]["methods"]) {
        methods.push_back(method["method"].get<std::string>() + "@" + method["sequence"].get<std::string>());
        EXPECT_EQ(method["passes"], (std::vector<int>{1, 2, 4, 5}));
        EXPECT_NEAR(method["gain"].get<double>(),
                    json[0]["methods"][0]["rmse"][3].get<double>() / method["rmse"][3].get<double>(),
                    2e-3 * method["gain"].get<double>()); // four digits are printed
    }
    EXPECT_EQ(methods, (std::vector<std::string>{"tristimulus:1@random", "illuminant:1@stratified", "rgb@stratified"}));
    EXPECT_EQ(json[0]["methods"][0]["gain"], 1.0);
    EXPECT_EQ(json[0]["methods"][2]["unbiased"], false);
}

TEST(BenchWavelengths, NeedsTwoRepeatsForAScatter) {
    const ChildResult result = run_tristim({"bench-wavelengths", flat_scene("f12"), "--repeats=1"});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_NE(result.standard_error.find("--repeats"), std::string::npos) << result.standard_error;
}

} // namespace
} // namespace tristim::test
