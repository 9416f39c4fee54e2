// The same kernels on Debian's three OpenCL implementations: PoCL, Oclgrind's simulator with its memory checks, and
// Mesa's rusticl on llvmpipe.

#include "image/compare_images.h"
#include "image/read_image.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
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
        fmt::format("{} '{}' render '{}/meshes/{}/scene.pbrt' --quiet --outfile '{}.exr' {} > '{}.log' 2>&1", before,
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
    const char* scene;
    const char* method;
};

class Oclgrind : public testing::TestWithParam<Case> {};

TEST_P(Oclgrind, ReportsNothing) {
    const auto [scene, method] = GetParam();
    const std::string options =
        fmt::format("--method {} --resolution 12x12 --photons 256 --passes 2 --initial-radius 0.2", method);
    const std::string name = fmt::format("{}-{}", scene, std::string(method).substr(0, 3));
    const Render simulated = render("oclgrind --data-races --check-api", scene, options, name + "-oclgrind");
    ASSERT_EQ(simulated.status, 0) << simulated.messages;
    EXPECT_EQ(simulated.messages, ""); // Oclgrind prints what it finds
    const Render native = render("", scene, options + " --device 'Portable Computing Language'", name + "-pocl");
    ASSERT_EQ(native.status, 0) << native.messages;
    expect_same_image(simulated, native);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Oclgrind,
                         testing::Values(Case{"dispersion", "tristimulus:1"}, Case{"dispersion", "spectral:400"},
                                         Case{"box", "rgb"}, Case{"prism", "tristimulus:4"}),
                         [](const auto& test) { return fmt::format("{}_{}", test.param.scene, test.index); });

TEST(Rusticl, RendersTheSameImage) {
    const std::string options = "--resolution 32x32 --photons 1024 --passes 2";
    const Render rusticl = render("RUSTICL_ENABLE=llvmpipe", "dispersion", options + " --device rusticl", "rusticl");
    ASSERT_EQ(rusticl.status, 0) << rusticl.messages;
    const Render native = render("", "dispersion", options + " --device 'Portable Computing Language'", "rusticl-pocl");
    ASSERT_EQ(native.status, 0) << native.messages;
    expect_same_image(rusticl, native);
}

} // namespace
} // namespace tristim
