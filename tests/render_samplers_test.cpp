// Every unbiased wavelength sampler converges to the image of spectral:400, where wavelengths part by dispersion and
// where films colour the light of a lamp of lines.
#include "image_statistics.h"
#include "sampler_oracle.h"
#include "test_names.h"

namespace tristim::test {
namespace {

struct SceneCase {
    const char* file; ///< in meshes/, without .pbrt
    double radius;
    int passes;
    bool lines; ///< a lamp of lines: samplers that do not know it need many wavelengths to meet enough of them
    bool short_run;
};

struct MethodRun {
    Method method;
    bool random;
};

/// The unbiased methods to compare: few wavelengths; one as far as it can tell anything, which with random sequences or
/// lamps of lines it cannot, nor in short runs where its pdf is far from the eye's sensitivity.
std::vector<MethodRun> runs_for(const SceneCase& scene) {
    std::vector<MethodRun> runs;
    for (const MethodKind& kind : method_kinds()) {
        if (!kind.unbiased || kind.kind == Method::Kind::Spectral)
            continue;
        const bool knows_light = kernel_test::heeds_light(kind.kind);
        const bool knows_eye = knows_light || kind.kind == Method::Kind::Mixture;
        const bool sets = kind.wavelengths == 3;
        const Method few{kind.kind, sets ? 1 : 4}, many{kind.kind, sets ? 20 : 64}, one{kind.kind, 1};
        const Method& method = scene.lines && !knows_light ? many : few;
        runs.push_back({method, false});
        if (long_tests())
            runs.push_back({method, true});
        if (!sets && !scene.lines && (knows_eye || long_tests()))
            runs.push_back({one, false});
    }
    return runs;
}

class Samplers : public testing::TestWithParam<SceneCase> {};

TEST_P(Samplers, ConvergeToTheSpectralImage) {
    const SceneCase& of = GetParam();
    if (!of.short_run && !long_tests())
        GTEST_SKIP() << "set TRISTIM_LONG_TESTS=1 for this scene";
    const Scene scene = load_scene(std::string(TRISTIM_SOURCE_DIR "/meshes/") + of.file + ".pbrt");
    const int passes = (long_tests() ? 4 : 1) * of.passes;
    const int runs = long_tests() ? 8 : 5;
    // Sharp features are compared over blocks, whose sums are closer to normal.
    constexpr int block = 8;
    std::uint32_t seed = 1;
    const auto render = [&](const Method& method, bool random) {
        // One wavelength varies most; and photons that dispersive glass left with one of 400 are so rare that the means
        // of few renders are not normal.
        const int seeds = runs * (method.wavelengths() == 1 ? 2 : method.wavelengths() == 400 && !of.lines ? 6 : 1);
        RenderOptions options = small_render(method.name(), 32, 32, 8192, of.radius, 12);
        options.random_sequence = random;
        seed += 1000; // others for each method, so that the sets are independent
        return block_means(render_seeds(scene, options, passes, seeds, seed), block);
    };
    const RenderSet spectral = render(parse_method("spectral:400"), false);
    for (const auto& [method, random] : runs_for(of)) {
        const Demands demands{2e-5, long_tests() && !random ? 0.03 : 0.06};
        expect_same(fmt::format("{}-{}{}", test_name(of.file), method.name(), random ? "-random" : ""),
                    render(method, random), spectral, demands);
    }
}

// The prism's scene can only be judged by few wavelengths: dispersed caustics seen through the prism need photons of
// the visible point's own wavelength, one in W, and by 400 such photons are too rare for a normal distribution.
INSTANTIATE_TEST_SUITE_P(Scenes, Samplers,
                         testing::Values(SceneCase{"dispersion/scene", 0.12, 12, false, true},
                                         SceneCase{"interference/scene", 0.2, 16, true, false},
                                         SceneCase{"interference-areas/a", 0.2, 16, true, false},
                                         SceneCase{"interference-areas/b", 0.2, 16, true, false},
                                         SceneCase{"interference-areas/c", 0.2, 16, true, false}),
                         [](const testing::TestParamInfo<SceneCase>& scene) { return test_name(scene.param.file); });

} // namespace
} // namespace tristim::test
