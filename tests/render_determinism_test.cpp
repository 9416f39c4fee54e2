// What must be the same bit for bit, and what must not.
#include "child_process.h"
#include "image/read_image.h"
#include "image_statistics.h"
#include "scene_folder.h"

#include <cstring>

namespace tristim::test {
namespace {

Scene dispersion_scene() {
    return load_scene(TRISTIM_SOURCE_DIR "/meshes/dispersion/scene.pbrt");
}

RenderOptions dispersion_options() {
    RenderOptions options = small_render("tristimulus:2", 24, 20, 4096, 0.1, 16);
    options.seed = 5;
    return options;
}

std::vector<std::array<float, 3>> render_bits(const Scene& scene, const RenderOptions& options,
                                              const std::vector<std::uint32_t>& passes) {
    Renderer renderer(scene, options, test_device());
    for (const std::uint32_t pass : passes)
        renderer.render_pass(pass);
    return renderer.film().xyz;
}

const std::vector<std::uint32_t> ascending{0, 1, 2, 3, 4, 5, 6, 7};

std::size_t differing(const std::vector<std::array<float, 3>>& a, const std::vector<std::array<float, 3>>& b) {
    std::size_t count = a.size() == b.size() ? 0 : std::max(a.size(), b.size());
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        count += std::memcmp(&a[i], &b[i], sizeof(a[i])) != 0 ? 1U : 0U;
    return count;
}

TEST(Determinism, SameSeedSameBitsOtherSeedOtherImage) {
    const Scene scene = dispersion_scene();
    for (const bool statistics : {false, true}) {
        RenderOptions options = dispersion_options();
        options.statistics_radius = statistics;
        options.radius.reset(); // the pilot must repeat too
        const auto first = render_bits(scene, options, ascending);
        EXPECT_EQ(differing(first, render_bits(scene, options, ascending)), 0U);
        options.seed = 6;
        // Every pixel that sees anything is jittered and lit by other photons.
        EXPECT_GT(differing(first, render_bits(scene, options, ascending)), first.size() / 2);
    }
}

/// The film's sums keep 72 bits.
TEST(Determinism, OrderOfPassesDoesNotShow) {
    const Scene scene = dispersion_scene();
    const RenderOptions options = dispersion_options();
    const auto forwards = render_bits(scene, options, ascending);
    EXPECT_EQ(differing(forwards, render_bits(scene, options, {7, 6, 5, 4, 3, 2, 1, 0})), 0U);
    EXPECT_EQ(differing(forwards, render_bits(scene, options, {3, 1, 4, 0, 5, 2, 7, 6})), 0U);
}

TEST(Determinism, PassesDoNotDependOnThePassesBefore) {
    const Scene scene = dispersion_scene();
    const RenderOptions options = dispersion_options();
    Renderer both(scene, options, test_device());
    both.render_pass(2);
    both.render_pass(3);
    const FilmImage mean = both.film();
    const auto second = render_bits(scene, options, {2});
    const auto third = render_bits(scene, options, {3});
    for (std::size_t i = 0; i < second.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            ASSERT_FLOAT_EQ(mean.xyz[i][c], 0.5F * (second[i][c] + third[i][c])) << "pixel " << i;
    }
}

TEST(Determinism, ARegionHasThePixelsOfTheWholeImage) {
    const Scene scene = dispersion_scene();
    for (const bool statistics : {false, true}) {
        RenderOptions options = dispersion_options();
        options.statistics_radius = statistics;
        const auto whole = render_bits(scene, options, ascending);
        options.region = {7, 5, 11, 9};
        const auto part = render_bits(scene, options, ascending);
        ASSERT_EQ(part.size(), 99U);
        for (int y = 0; y < 9; ++y) {
            for (int x = 0; x < 11; ++x) {
                const auto& a = whole[static_cast<std::size_t>((y + 5) * options.width + x + 7)];
                const auto& b = part[static_cast<std::size_t>(y * 11 + x)];
                ASSERT_EQ(std::memcmp(&a, &b, sizeof(a)), 0)
                    << "pixel (" << x + 7 << ", " << y + 5 << ") " << a[1] << " " << b[1];
            }
        }
    }
}

/// One thread and two, in processes of their own, since PoCL makes its threads when it starts.
TEST(Determinism, ThreadCountDoesNotMatter) {
    const SceneFolder folder;
    const auto render = [&folder](const std::string& threads) {
        const std::string path = folder.path(threads + ".exr");
        const ChildResult result =
            run_tristim({"render", TRISTIM_SOURCE_DIR "/meshes/dispersion/scene.pbrt", "--resolution", "24x20",
                         "--passes", "4", "--photons", "4096", "--quiet", "--space", "xyz", "--outfile", path},
                        {{"POCL_MAX_PTHREAD_COUNT", threads}});
        EXPECT_EQ(result.exit_code, 0) << result.standard_error;
        return read_exr(path).xyz;
    };
    EXPECT_EQ(differing(render("1"), render("2")), 0U);
}

} // namespace
} // namespace tristim::test
