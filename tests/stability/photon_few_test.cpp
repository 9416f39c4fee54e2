// Pixels that find no photon or one, radii at their floor, and photons of hardly any light.

#include "render/renderer.h"
#include "scene_folder.h"
#include "test_scenes.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tristim::test::few_photons_test {
namespace {

constexpr int side = 4;

/// A white floor of half side 1 under a distant light straight down: irradiance E, so radiance E ρ/π.
Scene sunlit_floor(double scale) {
    Scene scene;
    const int material = add_diffuse(scene, Spectrum::constant(0.5));
    add_horizontal_square(scene, 1.0, 0.0, true, material);
    Light light;
    light.kind = Light::Kind::Distant;
    light.emission = Spectrum::constant(1.0);
    light.scale = scale;
    light.direction = V3d(0, 0, -1);
    scene.lights.push_back(light);
    scene.camera = look_at({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 10.0);
    return scene;
}

RenderOptions photons_alone(int photons, double radius) {
    RenderOptions options = small_render("tristimulus:1", side, side, photons, radius, 2);
    options.direct_photons = true;
    return options;
}

/// With one photon in a pass, a pixel has none, and nothing, or just that one, and its flux over the disc.
TEST(PhotonStability, OnePhotonInAPass) {
    constexpr double radius = 0.5;
    Renderer renderer(sunlit_floor(1.0), photons_alone(1, radius), test_device());
    constexpr std::uint32_t passes = 1500;
    int found = 0;
    double sum = 0.0;
    for (std::uint32_t pass = 0; pass < passes; ++pass) {
        renderer.render_pass({pass, 0, 0, 0});
        const std::vector<Photon> photons = renderer.photons();
        for (const cl_float4& flux : renderer.gathered_flux()) {
            ASSERT_TRUE(flux.s[3] == 0.0F || flux.s[3] == 1.0F);
            if (flux.s[3] == 0.0F) {
                ASSERT_EQ(flux.s[1], 0.0F);
                continue;
            }
            ASSERT_FLOAT_EQ(flux.s[1], photons.front().flux_y);
            ++found;
            sum += flux.s[3];
        }
    }
    // The light's photons fall on a disc of the bounding sphere's radius, √2 and a little: a share r²/2 in each pixel's
    // disc.
    const double share = radius * radius / (2.0 * 1.0001 * 1.0001);
    const double expected = passes * side * side * share;
    // As if all 16 pixels saw the same photons: four standard deviations of a binomial.
    EXPECT_NEAR(found, expected, 4.0 * side * side * std::sqrt(passes * share * (1.0 - share)));
    const FilmImage film = renderer.film();
    EXPECT_EQ(film.rejected_samples, 0U);
    for (std::size_t i = 0; i < film.xyz.size(); ++i) {
        EXPECT_TRUE(std::isfinite(film.variance[i][1]));
        // The value of that share, of flux E π R² ρ/π each.
        EXPECT_NEAR(film.xyz[i][1] * std::acos(-1.0) / 0.5, 1.0, 4.0 / std::sqrt(passes * share));
    }
}

/// A floor that no photon meets: nothing but direct light, and no error.
TEST(PhotonStability, PixelsWithoutPhotons) {
    RenderOptions options = photons_alone(1024, 0.1);
    options.direct_photons = false; // the second hits that there are none of
    for (const bool statistics : {false, true}) {
        options.statistics_radius = statistics;
        Renderer renderer(sunlit_floor(1.0), options, test_device());
        for (std::uint32_t pass = 0; pass < 16; ++pass)
            renderer.render_pass(pass);
        const FilmImage film = renderer.film();
        EXPECT_EQ(film.rejected_samples, 0U);
        EXPECT_TRUE(renderer.photons().empty());
        for (const auto& xyz : film.xyz)
            EXPECT_NEAR(xyz[1], 0.5 / std::acos(-1.0), 2e-3) << "its wavelengths' mean";
    }
}

/// Radii too small to be squared, or below the spacing of floats, are raised: the image is right all the same.
TEST(PhotonStability, RadiiNearTheirFloor) {
    // Few photons fall into such a disc: what is tested is that none falls in too often and nothing is lost to 0/0.
    for (const double radius : {1e-18, 1e-12, 1e-7}) {
        Renderer renderer(sunlit_floor(1.0), photons_alone(65536, radius), test_device());
        renderer.render_pass(0);
        EXPECT_EQ(renderer.film().rejected_samples, 0U) << radius;
        for (const VisiblePoint& point : renderer.visible_points())
            EXPECT_FLOAT_EQ(point.radius, 0x1p-20F) << radius;
    }
    for (const double radius : {1e-25, 1e25}) {
        const std::string message =
            error_of([&] { Renderer(sunlit_floor(1.0), photons_alone(16, radius), test_device()); });
        expect_message(message, "an initial search radius of ", "is not between");
    }
}

/// Light scaled by powers of two scales the image and nothing else, down to photons that are barely normal floats.
TEST(PhotonStability, FaintAndStrongLightIsTheSameImage) {
    const auto render = [](double scale) {
        Renderer renderer(sunlit_floor(scale), photons_alone(4096, 0.3), test_device());
        for (std::uint32_t pass = 0; pass < 4; ++pass)
            renderer.render_pass(pass);
        const FilmImage film = renderer.film();
        EXPECT_EQ(film.rejected_samples, 0U) << scale;
        return film.xyz;
    };
    const auto plain = render(1.0);
    for (const int power : {-90, -40, 40, 80}) {
        const auto scaled = render(std::ldexp(1.0, power));
        for (std::size_t i = 0; i < plain.size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_FLOAT_EQ(std::ldexp(scaled[i][c], -power), plain[i][c]) << "2^" << power << ", pixel " << i;
        }
    }
}

} // namespace
} // namespace tristim::test::few_photons_test
