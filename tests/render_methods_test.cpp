// The methods' images of the scenes that come with the project: those that sample wavelengths converge to one image; rgb
// does not where colours come from dispersion.
#include "image_statistics.h"

#include <cmath>

namespace tristim::test {
namespace {

struct MethodCase {
    const char* method;
    bool random;
};

RenderSet render_method(const Scene& scene, const MethodCase& method, int photons, double radius, int passes, int runs,
                        std::uint32_t first_seed) {
    RenderOptions options = small_render(method.method, 32, 32, photons, radius, 12);
    options.random_sequence = method.random;
    return render_seeds(scene, options, passes, runs, first_seed);
}

/// Sharp features are compared over blocks, whose sums are closer to normal.
constexpr int block = 8;

struct SceneCase {
    const char* folder;
    double radius;
};

class Methods : public testing::TestWithParam<SceneCase> {};

TEST_P(Methods, ConvergeToOneImage) {
    const std::string name = GetParam().folder;
    const Scene scene = load_scene(TRISTIM_SOURCE_DIR "/meshes/" + name + "/scene.pbrt");
    const int passes = long_tests() ? 256 : 16;
    const int runs = long_tests() ? 16 : 6;
    const Demands demands{2e-5, long_tests() ? 0.01 : 0.05};
    std::uint32_t seed = 1;
    const auto render = [&](const MethodCase& method) {
        seed += 1000;
        return block_means(render_method(scene, method, 16384, GetParam().radius, passes, runs, seed), block);
    };
    const RenderSet spectral = render({"spectral:400", false});
    const RenderSet one = render({"tristimulus:1", false});
    const RenderSet one_random = render({"tristimulus:1", true});
    const RenderSet twenty = render({"tristimulus:20", false});
    const RenderSet twenty_random = render({"tristimulus:20", true});
    expect_same(name + "-tristimulus:1-spectral", one, spectral, demands);
    expect_same(name + "-tristimulus:20-spectral", twenty, spectral, demands);
    expect_same(name + "-tristimulus:1-tristimulus:20", one, twenty, demands);
    expect_same(name + "-tristimulus:1-random-spectral", one_random, spectral, demands);
    expect_same(name + "-tristimulus:20-random-spectral", twenty_random, spectral, demands);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Methods,
                         testing::Values(SceneCase{"dispersion", 0.12}, SceneCase{"prism", 0.12}, SceneCase{"box", 0.12}),
                         [](const testing::TestParamInfo<SceneCase>& scene) { return std::string(scene.param.folder); });

/// Root of the mean squared difference of two images' means, and what of it the standard errors explain.
struct Difference {
    double rmse = 0.0;
    double noise = 0.0;
};

Difference difference(const RenderSet& a, const RenderSet& b) {
    const std::size_t pixels = a.images.front().xyz.size();
    const double values = 3.0 * static_cast<double>(pixels);
    Difference d;
    for (std::size_t i = 0; i < pixels; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const Estimate of_a = estimate(samples_of(a, i, c));
            const Estimate of_b = estimate(samples_of(b, i, c));
            d.rmse += (of_a.mean - of_b.mean) * (of_a.mean - of_b.mean) / values;
            d.noise += (of_a.squared_error + of_b.squared_error) / values;
        }
    }
    d.rmse = std::sqrt(d.rmse);
    d.noise = std::sqrt(d.noise);
    return d;
}

/// The paper's point (its figure 3): rgb has no dispersion, so its caustic has another place and no colours. Its error is
/// a bias that more passes do not mend, many times what noise explains, while tristimulus:20's is noise alone.
TEST(RgbMethod, DoesNotConvergeToTheSpectralImageOfDispersion) {
    const Scene scene = load_scene(TRISTIM_SOURCE_DIR "/meshes/dispersion/scene.pbrt");
    const int passes = 24;
    const int runs = 6;
    const auto render = [&](const char* method, std::uint32_t seed) {
        return block_means(render_method(scene, {method, false}, 32768, 0.06, passes, runs, seed), 2);
    };
    const RenderSet spectral = render("spectral:400", 1);
    const Difference twenty = difference(render("tristimulus:20", 1001), spectral);
    const Difference rgb = difference(render("rgb", 2001), spectral);
    RecordProperty("rgb", std::to_string(rgb.rmse) + " " + std::to_string(rgb.noise));
    RecordProperty("twenty", std::to_string(twenty.rmse) + " " + std::to_string(twenty.noise));
    EXPECT_LT(twenty.rmse, 2.0 * twenty.noise);
    EXPECT_GT(rgb.rmse, 4.0 * rgb.noise) << "rgb: RMSE " << rgb.rmse << ", noise " << rgb.noise;
    EXPECT_GT(rgb.rmse, 3.0 * twenty.rmse) << "tristimulus:20: RMSE " << twenty.rmse << ", noise " << twenty.noise;
}

} // namespace
} // namespace tristim::test
