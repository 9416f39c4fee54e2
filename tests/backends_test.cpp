// The same kernels on Debian's three OpenCL implementations: PoCL, Oclgrind's simulator with its memory checks, and
// Mesa's rusticl on llvmpipe.

#include "child_process.h"
#include "image/compare_images.h"
#include "image/read_image.h"
#include "scene_folder.h"
#include "test_scenes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
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

/// Same seed, same samples: images differ by rounding, and by the few paths that rounding sends another way.
void expect_same_image(const Render& one, const Render& other) {
    const ImageDifference difference = compare_images(read_exr(one.image), read_exr(other.image));
    EXPECT_LT(difference.rmse, 0.01 * difference.mean_xyz_b[1]);
    EXPECT_GT(difference.mean_xyz_b[1], 0.0);
}

struct Case {
    const char* scene; ///< in meshes/, without .pbrt
    const char* method;
};

/// The part of a scene's name before the '/', for files and names of tests.
std::string folder(const std::string& scene) {
    std::string name = scene.substr(0, scene.find('/'));
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

class Oclgrind : public testing::TestWithParam<Case> {};

TEST_P(Oclgrind, ReportsNothing) {
    const auto [scene, method] = GetParam();
    const std::string options =
        fmt::format("--method {} --resolution 12x12 --photons 256 --passes 2 --initial-radius 0.2", method);
    const std::string name = fmt::format("{}-{}", folder(scene), std::string(method).substr(0, 3));
    const Render simulated = render("oclgrind --data-races --check-api", scene, options, name + "-oclgrind");
    ASSERT_EQ(simulated.status, 0) << simulated.messages;
    EXPECT_EQ(simulated.messages, ""); // Oclgrind prints what it finds
    const Render native = render("", scene, options + " --device 'Portable Computing Language'", name + "-pocl");
    ASSERT_EQ(native.status, 0) << native.messages;
    expect_same_image(simulated, native);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Oclgrind,
                         testing::Values(Case{"dispersion/scene", "tristimulus:1"},
                                         Case{"dispersion/scene", "spectral:400"}, Case{"box/scene", "rgb"},
                                         Case{"prism/scene", "tristimulus:4"}, Case{"interference/scene", "rgb"},
                                         Case{"interference-areas/c", "tristimulus:1"},
                                         Case{"anodised-titanium/scene", "tristimulus:1"}),
                         [](const auto& test) { return fmt::format("{}_{}", folder(test.param.scene), test.index); });

struct RusticlCase {
    const char* scene;
    bool slow; ///< rusticl inlines every function: films and rough surfaces build for minutes
};

class Rusticl : public testing::TestWithParam<RusticlCase> {};

TEST_P(Rusticl, RendersTheSameImage) {
    const auto [scene, slow] = GetParam();
    if (slow && !test::long_tests())
        GTEST_SKIP() << "set TRISTIM_LONG_TESTS=1 for a build of minutes";
    const std::string options = "--resolution 32x32 --photons 1024 --passes 2";
    const std::string name = "rusticl-" + folder(scene);
    const Render rusticl = render("RUSTICL_ENABLE=llvmpipe", scene, options + " --device rusticl", name);
    ASSERT_EQ(rusticl.status, 0) << rusticl.messages;
    const Render native = render("", scene, options + " --device 'Portable Computing Language'", name + "-pocl");
    ASSERT_EQ(native.status, 0) << native.messages;
    expect_same_image(rusticl, native);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Rusticl,
                         testing::Values(RusticlCase{"dispersion/scene", false},
                                         RusticlCase{"anodised-titanium/scene", true},
                                         RusticlCase{"interference-areas/c", true}),
                         [](const auto& test) { return folder(test.param.scene); });

/// Runs this program's tests SamplerTables (kernel_samplers_test.cpp) on another device: the tables of wavelengths and
/// weights that every sampler fills, against formulas in double. Only in a process of its own: platforms are there from
/// the start or never.
void expect_sampler_tables(std::vector<std::string> words, std::map<std::string, std::string> environment,
                           const std::string& device) {
    environment["TRISTIM_DEVICE"] = device;
    words.push_back(std::filesystem::read_symlink("/proc/self/exe").string());
    words.push_back("--gtest_filter=SamplerTables.*");
    const test::ChildResult child = test::run_program("/usr/bin/env", words, environment);
    EXPECT_EQ(child.exit_code, 0) << child.standard_output << child.standard_error;
    EXPECT_NE(child.standard_output.find("SamplerTables.HoldTheWavelengths"), std::string::npos)
        << "the tests of the tables did not run";
}

TEST(OclgrindSamplers, FillTheSameTables) {
    const test::SceneFolder folder;
    const std::string log = folder.path("oclgrind.log");
    expect_sampler_tables({"oclgrind", "--data-races", "--check-api", "--log", log}, {}, "oclgrind");
    EXPECT_TRUE(std::filesystem::exists(log));
    EXPECT_EQ(test::read_text(log), "");
}

TEST(RusticlSamplers, FillTheSameTables) {
    expect_sampler_tables({}, {{"RUSTICL_ENABLE", "llvmpipe"}}, "rusticl");
}

} // namespace
} // namespace tristim
