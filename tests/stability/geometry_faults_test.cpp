// The cases of selftest that cast rays: what they found before the kernels were mended, that they find faults, and more
// rays than selftest has time for.
#include "selftest/geometry_measures.h"
#include "test_scenes.h"

#include <algorithm>
#include <fstream>
#include <gtest/gtest.h>
#include <map>

namespace tristim::selftest {
namespace {

using Measure = Measurement (*)(const GeometryKernels&, const Setting&);

Setting setting(double effort) {
    return {test::test_device(), false, effort};
}

double bound_of(const std::string& name) {
    for (const Case& c : geometry_cases()) {
        if (c.name == name)
            return c.bound;
    }
    ADD_FAILURE() << "no case \"" << name << "\"";
    return 0.0;
}

/// The worst that a case finds in kernels with a piece of their text replaced.
double worst_of_changed(const std::string& piece, const std::string& replacement, Measure measure) {
    std::string text = flatten_kernel_source("selftest/geometry.cl");
    const std::size_t at = text.find(piece);
    if (at == std::string::npos) {
        ADD_FAILURE() << "the kernels do not hold \"" << piece << "\"";
        return 0.0;
    }
    text.replace(at, piece.size(), replacement);
    return measure(GeometryKernels(test::test_device(), text), setting(0.25)).worst;
}

TEST(GeometryStability, FaultsInTheEdgeFunctionAreFound) {
    const char* piece = "return difference + lost;";
    const char* fused = "return difference;";
    EXPECT_GT(worst_of_changed(piece, fused, leaks_by_scale), 0.0);
    const char* plain = "return a_x * b_y - right;";
    EXPECT_GT(worst_of_changed(piece, plain, hits_by_aspect), bound_of("hits on needles, aspect ratio 1 to 1e7"));
    EXPECT_GT(worst_of_changed(piece, plain, hits_by_cosine), bound_of("hits, cosine 1 to 1e-8"));
}

TEST(GeometryStability, FaultsInTheOffsetFromSurfacesAreFound) {
    const char* piece = "BVH_LEAVING * extent";
    EXPECT_GT(worst_of_changed(piece, "0.0f", leaving_by_scale), 0.0);
    EXPECT_GT(worst_of_changed(piece, "0.0f", leaving_by_cosine), 0.0);
    EXPECT_GT(worst_of_changed(piece, "0.0f", leaving_by_aspect), 0.0);
    EXPECT_GT(worst_of_changed(piece, "0.0f", leaving_meshes), 0.0);
    EXPECT_GT(worst_of_changed(piece, "1e-4f", leaving_by_distance), 0.0) << "a fixed step";
    EXPECT_GT(worst_of_changed("max(light->extent, 1.0f / inverse_distance)", "light->extent", shadows_by_distance),
              0.0);
}

TEST(GeometryStability, FaultsInTheBoxesAreFound) {
    // Only exits and entries as tight as the plain slab test, and the hits that it is given to find.
    EXPECT_GT(worst_of_changed(
                  "const BvhFloats exit_t = min(min(exit_x, exit_y), min(exit_z, (BvhFloats)(t_max)));",
                  "const BvhFloats exit_t = min(min(exit_x, exit_y), min(exit_z, (BvhFloats)(t_max))) * 0.999998f;",
                  leaks_by_scale),
              0.0);
}

/// Rows of case, parameter, error: from before exact edge functions and offsets that follow the coordinates.
std::map<std::string, std::vector<CurvePoint>> curves_before() {
    std::map<std::string, std::vector<CurvePoint>> curves;
    std::ifstream file(TRISTIM_SOURCE_DIR "/tests/stability/data/geometry-rays-before.csv");
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
        const std::size_t first = line.find(';'), second = line.find(';', first + 1);
        curves[line.substr(0, first)].push_back(
            {std::stod(line.substr(first + 1, second - first - 1)), std::stod(line.substr(second + 1))});
    }
    return curves;
}

TEST(GeometryStability, EveryCurveThatRoseAboveItsBoundIsBelowItNow) {
    const auto before = curves_before();
    ASSERT_GE(before.size(), 6U);
    for (const Case& c : geometry_cases()) {
        const auto found = before.find(c.name);
        if (found == before.end())
            continue;
        const auto exceeds = [&c](const CurvePoint& point) { return point.error > c.bound; };
        EXPECT_TRUE(std::any_of(found->second.begin(), found->second.end(), exceeds)) << c.name;
        const Measurement now = c.measure(setting(1.0));
        EXPECT_EQ(now.curve.size(), found->second.size()) << c.name;
        EXPECT_TRUE(std::none_of(now.curve.begin(), now.curve.end(), exceeds)) << c.name << ": " << now.where;
    }
}

TEST(GeometryStability, NoneOfMillionsOfRaysLeavesAClosedMesh) {
    const GeometryKernels kernels(setting(1.0));
    constexpr std::size_t batch = std::size_t{1} << 19;
    const std::size_t batches = test::long_tests() ? 50 : 1; // for each of four meshes: 10^8 rays in the long form
    Random random(10);
    for (const char* name : {"box", "divided box", "icosphere", "spindle"}) {
        const V3d centre = 3.0 * random.direction();
        const GeometryMesh mesh(kernels.device(), closed_mesh(name, 1.0, centre));
        for (std::size_t i = 0; i < batches; ++i)
            ASSERT_EQ(leaks(kernels, mesh, centre, 1.0, batch, random), 0U) << name << ", batch " << i;
    }
}

} // namespace
} // namespace tristim::selftest
