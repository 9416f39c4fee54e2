// The wavelength that camera paths keep behind dispersive surfaces: over the passes each pixel sees all of them.
#include "discrepancy.h"
#include "render/renderer.h"
#include "test_scenes.h"

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

namespace tristim::test {
namespace {

/// A grey floor seen straight through a slab of dense flint.
Scene floor_behind_glass() {
    Scene scene;
    scene.camera = look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 10.0);
    scene.lights.push_back(environment(Spectrum::constant(1.0)));
    add_horizontal_square(scene, 5.0, 0.0, true, add_diffuse(scene, Spectrum::constant(0.5)));
    add_box(scene, {-2, -2, 1}, {2, 2, 2}, false, add_dielectric(scene, Spectrum::named("glass-SF11")));
    return scene;
}

class EyeSlots : public testing::TestWithParam<int> {};

/// A pixel's wavelengths are position (slot + v)/W in [380, 780) nm, with v of the pass. Were slots and passes to go in
/// step, a pixel would see only a part of each stratum however long it is rendered. Independent random slots
/// and positions would have a discrepancy above 2.5/√n in one of 10⁵ pixels (Kolmogorov); ours are to be no worse.
TEST_P(EyeSlots, PixelsSeeAllWavelengths) {
    const int w = GetParam();
    RenderOptions options = small_render("uniform:" + std::to_string(w), 4, 4, 1, 0.1, 6);
    Renderer renderer(floor_behind_glass(), options, test_device());
    constexpr std::uint32_t passes = 512;
    std::vector<std::vector<double>> positions(16);
    std::vector<std::vector<int>> visits(16, std::vector<int>(static_cast<std::size_t>(w), 0));
    for (std::uint32_t pass = 0; pass < passes; ++pass) {
        renderer.render_pass(pass);
        const std::vector<float> lambdas = renderer.pass_table();
        const std::vector<VisiblePoint> points = renderer.visible_points();
        for (std::size_t pixel = 0; pixel < points.size(); ++pixel) {
            if (points[pixel].slot < 0)
                continue; // reflected away
            const auto slot = static_cast<std::size_t>(points[pixel].slot);
            positions[pixel].push_back((double{lambdas[slot]} - 380.0) / 400.0);
            ++visits[pixel][slot];
        }
    }
    for (std::size_t pixel = 0; pixel < positions.size(); ++pixel) {
        const auto n = static_cast<double>(positions[pixel].size());
        ASSERT_GT(n, 0.6 * passes) << "most paths go through the glass";
        EXPECT_LT(star_discrepancy(positions[pixel]), 2.5 / std::sqrt(n)) << "pixel " << pixel;
        for (const int visited : visits[pixel]) // four standard deviations of a binomial
            EXPECT_NEAR(visited, n / w, 4.0 * std::sqrt(n / w)) << "pixel " << pixel;
    }
}

INSTANTIATE_TEST_SUITE_P(Wavelengths, EyeSlots, testing::Values(1, 3, 4, 8, 60),
                         [](const auto& w) { return fmt::format("W{}", w.param); });

} // namespace
} // namespace tristim::test
