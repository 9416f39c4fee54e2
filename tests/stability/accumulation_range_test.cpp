// Images whose pixels differ by 24 orders of magnitude, and a film that passes are added to for long.

#include "render/renderer.h"
#include "test_scenes.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tristim::test {
namespace {

constexpr int patches = 25; // of 1e-12 to 1e12

double magnitude(int patch) {
    return std::pow(10.0, patch - 12);
}

/// A row of squares in the plane z = 0, seen from above, a pixel each: pixel x sees the x-th.
Camera above_the_row() {
    // The field of view spans the shorter side, one square of side 1 at a distance of 100.
    return look_at({0, 0, 100}, {0, 0, 0}, {0, 1, 0}, 2.0 * std::atan(0.5 / 100.0) * 180.0 / std::acos(-1.0));
}

void add_patch(Scene& scene, int patch, int material, int light = -1) {
    add_parallelogram(scene, {patch - 0.5 * patches, -0.5, 0}, {1, 0, 0}, {0, 1, 0}, material, light);
}

/// A spectrum that the wavelengths of the passes tell apart, so that pixels have an error bar.
Spectrum coloured() {
    return Spectrum::named("stdillum-A");
}

FilmImage render(const Scene& scene, int passes) {
    const RenderOptions options = small_render("tristimulus:1", patches, 1, 64, 0.1, 3);
    Renderer renderer(scene, options, test_device());
    for (int pass = 0; pass < passes; ++pass)
        renderer.render_pass(static_cast<std::uint32_t>(pass));
    EXPECT_EQ(renderer.film().rejected_samples, 0U);
    return renderer.film();
}

/// The same wavelengths make the same sum and the same error bar in each pixel, to rounding.
void expect_magnitudes(const FilmImage& film) {
    for (int patch = 0; patch < patches; ++patch) {
        const auto i = static_cast<std::size_t>(patch);
        const double scale = magnitude(patch) / magnitude(0);
        for (std::size_t c = 0; c < 3; ++c) {
            const double first = film.xyz[0][c];
            EXPECT_NEAR(film.xyz[i][c] / first / scale, 1.0, 1e-6) << "patch " << patch;
            // The same relative error bar.
            EXPECT_NEAR(double{film.variance[i][c]} / film.variance[0][c] / (scale * scale), 1.0, 1e-3)
                << "patch " << patch;
        }
    }
}

TEST(AccumulationStability, LightsOf24OrdersOfMagnitudeInOneImage) {
    Scene scene;
    scene.camera = above_the_row();
    const int black = add_diffuse(scene, Spectrum::constant(0.0));
    for (int patch = 0; patch < patches; ++patch)
        add_patch(scene, patch, black, add_area_light(scene, coloured(), magnitude(patch)));
    expect_magnitudes(render(scene, 32));
}

TEST(AccumulationStability, ReflectancesOf24OrdersOfMagnitudeInOneImage) {
    Scene scene;
    scene.camera = above_the_row();
    for (int patch = 0; patch < patches; ++patch)
        add_patch(scene, patch, add_diffuse(scene, Spectrum::constant(1e-12 * magnitude(patch))));
    Light light;
    light.kind = Light::Kind::Distant;
    light.emission = coloured();
    light.scale = 1e12;
    light.direction = V3d(0, 0, -1);
    scene.lights.push_back(light);
    expect_magnitudes(render(scene, 32));
}

} // namespace
} // namespace tristim::test
