// The same kernels on Debian's three OpenCL implementations: PoCL, Oclgrind's simulator with its memory checks, and
// Mesa's rusticl on llvmpipe.

#include "child_process.h"
#include "image/compare_images.h"
#include "image/read_image.h"
#include "image_statistics.h"
#include "scene_folder.h"
#include "test_scenes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace tristim {
namespace {

struct Render {
    int status;
    std::string messages;
    std::string image;
};

/// Renders a scene by the command, with `before` (environment or wrapper) in front of it.
Render render(const std::string& before, const std::string& scene, const std::string& options,
              const std::string& name) {
    const std::string base = testing::TempDir() + "tristim-backend-" + name;
    const std::string command =
        fmt::format("{} '{}' render '{}/meshes/{}.pbrt' --quiet --outfile '{}.exr' {} > '{}.log' 2>&1", before,
                    TRISTIM_COMMAND, TRISTIM_SOURCE_DIR, scene, base, options, base);
    const int status = std::system(command.c_str());
    std::ostringstream messages;
    messages << std::ifstream(base + ".log").rdbuf();
    return {status, messages.str(), base + ".exr"};
}

/// Whether a platform is installed, as far as the command sees it with `before` in front.
bool has_platform(const std::string& before, const std::string& platform) {
    return std::system(fmt::format("{} '{}' devices 2>&1 | grep -q '{}'", before, TRISTIM_COMMAND, platform).c_str()) ==
           0;
}

/// Ends a test on a platform that is not installed.
#define SKIP_WITHOUT_OCLGRIND()                                                                                        \
    if (!has_platform("oclgrind", "Oclgrind"))                                                                         \
    GTEST_SKIP() << "Oclgrind is not installed"
#define SKIP_WITHOUT_RUSTICL()                                                                                         \
    if (!has_platform("RUSTICL_ENABLE=llvmpipe", "platform rusticl"))                                                  \
    GTEST_SKIP() << "Mesa's rusticl is not installed"

const std::string on_pocl = " --device 'Portable Computing Language'";
const std::string on_rusticl = " --device rusticl";

/// Same seed, same samples: images differ by rounding, and by the few paths that rounding sends another way.
void expect_same_image(const Render& one, const Render& other) {
    const ImageDifference difference = compare_images(read_exr(one.image), read_exr(other.image));
    EXPECT_LT(difference.rmse, 0.01 * difference.mean_xyz_b[1]);
    EXPECT_GT(difference.mean_xyz_b[1], 0.0);
    testing::Test::RecordProperty("rmse", fmt::format("{:.2g}", difference.rmse));
}

/// The part of a scene's name before the '/', for files and names of tests.
std::string folder(const std::string& scene) {
    std::string name = scene.substr(0, scene.find('/'));
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

struct OclgrindCase {
    const char* scene; ///< in meshes/, without .pbrt
    const char* method;
    bool slow = false;
};

class Oclgrind : public testing::TestWithParam<OclgrindCase> {};

TEST_P(Oclgrind, ReportsNothing) {
    const auto [scene, method, slow] = GetParam();
    if (slow && !test::long_tests())
        GTEST_SKIP() << "set TRISTIM_LONG_TESTS=1 for every scene";
    SKIP_WITHOUT_OCLGRIND();
    const std::string options =
        fmt::format("--method {} --resolution 12x12 --photons 256 --passes 2 --initial-radius 0.2", method);
    const std::string name = fmt::format("{}-{}", folder(scene), std::string(method).substr(0, 3));
    const Render simulated = render("oclgrind --data-races --check-api", scene, options, name + "-oclgrind");
    ASSERT_EQ(simulated.status, 0) << simulated.messages;
    EXPECT_EQ(simulated.messages, ""); // Oclgrind prints what it finds
    const Render native = render("", scene, options + on_pocl, name + "-pocl");
    ASSERT_EQ(native.status, 0) << native.messages;
    expect_same_image(simulated, native);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Oclgrind,
                         testing::Values(OclgrindCase{"dispersion/scene", "tristimulus:1"},
                                         OclgrindCase{"dispersion/scene", "spectral:400"},
                                         OclgrindCase{"box/scene", "rgb"},
                                         OclgrindCase{"prism/scene", "tristimulus:4", true},
                                         OclgrindCase{"interference/scene", "rgb", true},
                                         OclgrindCase{"interference-areas/c", "tristimulus:1", true},
                                         OclgrindCase{"anodised-titanium/scene", "tristimulus:1"},
                                         OclgrindCase{"soap-bubble/scene", "tristimulus:1", true},
                                         OclgrindCase{"antireflection/scene", "tristimulus:1", true},
                                         OclgrindCase{"bragg-mirror/scene", "tristimulus:1", true}),
                         [](const auto& test) { return fmt::format("{}_{}", folder(test.param.scene), test.index); });

/// rusticl builds the programs of a scene for 3 to 20 seconds. Here one; the others, and renders of independent seeds,
/// behind TRISTIM_LONG_TESTS=1.
class Rusticl : public testing::TestWithParam<const char*> {};

TEST_P(Rusticl, RendersTheSameImage) {
    const std::string scene = GetParam();
    if (scene != "dispersion/scene" && !test::long_tests())
        GTEST_SKIP() << "set TRISTIM_LONG_TESTS=1 for every scene";
    SKIP_WITHOUT_RUSTICL();
    const std::string options = "--resolution 24x16 --photons 1024 --passes 2";
    const std::string name = "rusticl-" + folder(scene);
    const Render rusticl = render("RUSTICL_ENABLE=llvmpipe", scene, options + on_rusticl, name);
    ASSERT_EQ(rusticl.status, 0) << rusticl.messages;
    const Render native = render("", scene, options + on_pocl, name + "-pocl");
    ASSERT_EQ(native.status, 0) << native.messages;
    expect_same_image(rusticl, native);
}

/// Renders of a scene with seeds from `first_seed` on.
test::RenderSet render_seeds(const std::string& environment, const std::string& scene, const std::string& options,
                             const std::string& name, int first_seed) {
    constexpr int runs = 8;
    test::RenderSet set;
    for (int seed = first_seed; seed < first_seed + runs; ++seed) {
        const Render run = render(environment, scene, fmt::format("{} --seed {}", options, seed), name);
        EXPECT_EQ(run.status, 0) << run.messages;
        if (run.status != 0)
            break;
        const XyzImage image = read_exr(run.image);
        test::TestImage& kept = set.images.emplace_back(test::TestImage{image.full_width, image.full_height, {}});
        for (const auto& [x, y, z] : image.xyz)
            kept.xyz.push_back({x, y, z});
    }
    return set;
}

/// With seeds of their own, images agree in the mean over blocks of 4×4 pixels. The tolerance is rounding's: of some
/// thousand sums of a float, each off by 2^-24 of its part.
TEST_P(Rusticl, RendersTheSameMean) {
    if (!test::long_tests())
        GTEST_SKIP() << "set TRISTIM_LONG_TESTS=1 for renders of independent seeds";
    SKIP_WITHOUT_RUSTICL();
    const std::string scene = GetParam(), options = "--resolution 24x16 --photons 1024 --passes 4 --initial-radius 0.2";
    const std::string name = "seeds-" + folder(scene);
    const test::RenderSet rusticl =
        block_means(render_seeds("RUSTICL_ENABLE=llvmpipe", scene, options + on_rusticl, name, 1), 4);
    const test::RenderSet native = block_means(render_seeds("", scene, options + on_pocl, name, 101), 4);
    ASSERT_EQ(rusticl.images.size(), native.images.size());
    ASSERT_GT(native.images.size(), 1U);
    const std::size_t blocks = native.images.front().xyz.size();
    const double least_p = test::family_error / static_cast<double>(3 * blocks);
    for (std::size_t i = 0; i < 3 * blocks; ++i) {
        const test::Estimate a = test::estimate(test::samples_of(rusticl, i / 3, i % 3));
        const test::Estimate b = test::estimate(test::samples_of(native, i / 3, i % 3));
        const test::Comparison c =
            compare_estimates(a, rusticl.images.size(), b, native.images.size(), 1e-5 * std::abs(b.mean));
        EXPECT_GT(c.p, least_p) << "block " << i / 3 << ", channel " << i % 3 << ": " << a.mean << " and " << b.mean;
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Rusticl,
                         testing::Values("dispersion/scene", "box/scene", "prism/scene", "soap-bubble/scene",
                                         "interference/scene", "interference-areas/c", "antireflection/scene",
                                         "bragg-mirror/scene", "anodised-titanium/scene"),
                         [](const auto& test) { return folder(test.param); });

/// Runs some of this program's tests on another device. Only in a process of its own: platforms are there from the
/// start or never. `one` is the name of one of the tests.
void expect_tests_to_pass(const std::string& filter, const std::string& one, std::vector<std::string> words,
                          std::map<std::string, std::string> environment, const std::string& device) {
    environment["TRISTIM_DEVICE"] = device;
    words.push_back(std::filesystem::read_symlink("/proc/self/exe").string());
    words.push_back("--gtest_filter=" + filter);
    const test::ChildResult child = test::run_program("/usr/bin/env", words, environment);
    EXPECT_EQ(child.exit_code, 0) << child.standard_output << child.standard_error;
    EXPECT_NE(child.standard_output.find(one), std::string::npos) << "the tests did not run";
}

/// Those of kernel_samplers_test.cpp: the tables of wavelengths and weights that every sampler fills, against formulas
/// in double.
void expect_sampler_tables(std::vector<std::string> words, std::map<std::string, std::string> environment,
                           const std::string& device) {
    expect_tests_to_pass("SamplerTables.*", "SamplerTables.HoldTheWavelengths", std::move(words),
                         std::move(environment), device);
}

TEST(OclgrindSamplers, FillTheSameTables) {
    SKIP_WITHOUT_OCLGRIND();
    const test::SceneFolder folder;
    const std::string log = folder.path("oclgrind.log");
    expect_sampler_tables({"oclgrind", "--data-races", "--check-api", "--log", log}, {}, "oclgrind");
    EXPECT_TRUE(std::filesystem::exists(log));
    EXPECT_EQ(test::read_text(log), "");
}

TEST(RusticlSamplers, FillTheSameTables) {
    SKIP_WITHOUT_RUSTICL();
    expect_sampler_tables({}, {{"RUSTICL_ENABLE", "llvmpipe"}}, "rusticl");
}

/// rusticl's compiler might rearrange sums that must not be, and llvmpipe does end loops early.
TEST(RusticlArithmetic, IsExactAndTellsOfCutLoops) {
    SKIP_WITHOUT_RUSTICL();
    expect_tests_to_pass("KernelMultiplyAdd.*:KernelLoops.*", "KernelLoops.CountsThoseThatWereCut", {},
                         {{"RUSTICL_ENABLE", "llvmpipe"}}, "rusticl");
}

/// A search among more photons than the steps that llvmpipe's loops may take.
TEST(RusticlLoops, EndInAnErrorWhereLightWouldBeLost) {
    if (!test::long_tests())
        GTEST_SKIP() << "set TRISTIM_LONG_TESTS=1 for a search of seconds";
    SKIP_WITHOUT_RUSTICL();
    const Render cut = render("RUSTICL_ENABLE=llvmpipe", "box/scene",
                              "--resolution 8x8 --photons 131072 --passes 1 --initial-radius 50" + on_rusticl, "cut");
    EXPECT_NE(cut.status, 0);
    EXPECT_NE(cut.messages.find("ended the loops of"), std::string::npos) << cut.messages;
}

} // namespace
} // namespace tristim
