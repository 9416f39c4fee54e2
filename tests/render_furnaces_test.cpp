// Scenes whose radiance is the same everywhere, and reflection of a uniform environment: exact radiance by energy
// balance.
#include "image_statistics.h"
#include "method_cases.h"

#include <cmath>

namespace tristim::test {
namespace {

Light uniform_environment(const Spectrum& emission, double radiance) {
    Light light;
    light.kind = Light::Kind::Infinite;
    light.emission = emission;
    light.scale = radiance;
    return light;
}

TestImage uniform_image(int width, int height, const Xyz& xyz) {
    return {width, height, std::vector<Xyz>(static_cast<std::size_t>(width * height), xyz)};
}

TEST(Furnace, EmptySceneShowsTheEnvironment) {
    const Spectrum d65 = Spectrum::named("stdillum-D65");
    Scene scene;
    scene.path = "environment";
    scene.camera = look_at({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, 40.0);
    scene.lights = {uniform_environment(d65, 2.5)};
    // Behind the camera: an empty scene is none.
    add_parallelogram(scene, {-5, -1, -1}, {0, 1, 0}, {0, 0, 1}, add_diffuse(scene, Spectrum::constant(0.5)));
    const Xyz exact = integrate_xyz(d65, [](double) { return 2.5; });
    for (const char* method : {"tristimulus:1", "tristimulus:20", "spectral:400", "rgb"}) {
        const RenderOptions options = small_render(method, 4, 4, 64, 0.1, 4);
        expect_exact(std::string("environment-") + method, render_seeds(scene, options, 64, 4),
                     uniform_image(4, 4, exact));
    }
}

class DiffuseFurnace : public testing::TestWithParam<MethodCase> {};

/// A closed box whose walls all emit 0.5 and reflect half of what they receive: L = 0.5 + 0.5 L = 1 everywhere, as
/// 0.5^64 is nothing. The camera looks at the middle of a wall, since a search disc that reaches over an edge would
/// miss some of its photons.
TEST_P(DiffuseFurnace, HasRadianceOne) {
    if (std::string(GetParam().method) == "tristimulus:20" && !long_tests())
        GTEST_SKIP() << "set TRISTIM_LONG_TESTS=1";
    const Spectrum white = Spectrum::named("stdillum-D65");
    Scene scene;
    scene.path = "furnace";
    scene.camera = look_at({0, 0, 0}, {1, 0.1, 0.05}, {0, 0, 1}, 30.0);
    add_box(scene, {-1, -1, -1}, {1, 1, 1}, true, add_diffuse(scene, Spectrum::constant(0.5)),
            add_area_light(scene, white, 0.5));
    RenderOptions options = small_render(GetParam().method, 8, 8, 8192, 0.3, 64);
    options.direct_photons = GetParam().direct_photons;
    expect_exact("furnace-" + method_case_name({GetParam(), 0}), render_seeds(scene, options, 24, 8),
                 uniform_image(8, 8, integrate_xyz(white, [](double) { return 1.0; })), {2e-5, 0.006});
}

INSTANTIATE_TEST_SUITE_P(Methods, DiffuseFurnace,
                         testing::Values(MethodCase{"tristimulus:1", false}, MethodCase{"tristimulus:1", true},
                                         MethodCase{"tristimulus:20", false}, MethodCase{"tristimulus:20", true},
                                         MethodCase{"spectral:400", false}, MethodCase{"spectral:400", true},
                                         MethodCase{"rgb", false}, MethodCase{"rgb", true}),
                         method_case_name);

/// A sphere of glass in uniform radiance 1, which absorbs nothing: it cannot be seen. Reflection and refraction are
/// chosen by chance without a change of weight, and 1/η² on the way in is η² on the way out.
RenderSet render_glass(int subdivisions, bool vertex_normals, const Spectrum& eta) {
    Scene scene;
    scene.path = "glass";
    scene.camera = look_at({0, -4, 1}, {0, 0, 0}, {0, 0, 1}, 32.0);
    scene.lights = {uniform_environment(Spectrum::constant(1.0), 1.0)};
    add_sphere(scene, 1.0, subdivisions, vertex_normals, add_dielectric(scene, eta));
    return render_seeds(scene, small_render("tristimulus:1", 24, 24, 64, 0.1, 256), 12, 6);
}

Xyz white() {
    return integrate_xyz(Spectrum::constant(1.0), [](double) { return 1.0; });
}

/// Every path must return the environment, but for the rounding of 1/η² and η².
TEST(GlassFurnace, FacetedSphereIsInvisible) {
    const Xyz one = white();
    for (const TestImage& image : render_glass(2, false, Spectrum::constant(1.5)).images) {
        for (std::size_t pixel = 0; pixel < image.xyz.size(); ++pixel)
            ASSERT_NEAR(image.xyz[pixel][1], one[1], 1e-5) << "pixel (" << pixel % 24 << ", " << pixel / 24 << ")";
    }
}

TEST(GlassFurnace, FacetedDispersiveSphereIsInvisible) {
    expect_exact("faceted_dispersive", render_glass(2, false, Spectrum::named("glass-F11")),
                 uniform_image(24, 24, white()), {2e-5, 0.01});
}

/// Mean of 1 - Y over all pixels; no pixel may gain.
double mean_loss(const RenderSet& set) {
    const Xyz one = white();
    double loss = 0.0;
    double count = 0.0;
    for (const TestImage& image : set.images) {
        for (const Xyz& xyz : image.xyz) {
            EXPECT_LE(xyz[1], one[1] + 1e-5);
            loss += one[1] - xyz[1];
            count += 1.0;
        }
    }
    return loss / count;
}

/// Reflection about interpolated normals does not conserve the density of rays: some that enter near the critical angle
/// stay by total reflection. That is an error of the facets, so it must shrink with them: two subdivisions make them a
/// quarter as large, and the loss less than half.
TEST(GlassFurnace, SmoothSphereLosesLessAsFacetsShrink) {
    const double coarse = mean_loss(render_glass(2, true, Spectrum::constant(1.5)));
    const double fine = mean_loss(render_glass(4, true, Spectrum::constant(1.5)));
    RecordProperty("loss", fmt::format("{} -> {}", coarse, fine));
    EXPECT_LT(fine, 0.5 * coarse) << "of " << coarse;
}

} // namespace
} // namespace tristim::test
