// Glass of extreme and of matched indices in whole renders, whose radiance is known, and none of whose samples may be
// rejected (render_image demands that).
#include "image_statistics.h"
#include "rough_surfaces.h"

#include <cmath>
#include <numbers>
#include <string>

namespace tristim::test {
namespace {

using std::numbers::pi;

constexpr int side = 16;

Xyz white() {
    return integrate_xyz(Spectrum::constant(1.0), [](double) { return 1.0; });
}

/// Two area lights and a floor that photons light, seen past and through a sphere.
Scene lights_behind_a_sphere() {
    const Spectrum d65 = Spectrum::named("stdillum-D65");
    Scene scene;
    scene.path = "lights behind a sphere";
    scene.camera = look_at({0, -4, 1}, {0, 0, 0}, {0, 0, 1}, 40.0);
    add_horizontal_square(scene, 3.0, -1.2, true, add_diffuse(scene, Spectrum::constant(0.5)));
    const int black = add_diffuse(scene, Spectrum::constant(0.0));
    for (const double x : {-1.0, 0.3})
        add_parallelogram(scene, {x, 2.0, -0.5}, {0.7, 0, 0}, {0, 0, 1.0}, black, add_area_light(scene, d65, 1.0));
    return scene;
}

class MatchedSphere : public testing::TestWithParam<double> {};

/// Photons and camera paths go through the sphere as if it were not there, so that a pixel's samples are the same ones
/// but for the rounding of hits, which takes a photon in or out of a search radius, or a camera ray over an edge.
TEST_P(MatchedSphere, IsInvisible) {
    Scene scene = lights_behind_a_sphere();
    RenderOptions options = small_render("tristimulus:3", side, side, 16384, 0.2, 8);
    options.direct_photons = true;
    const TestImage empty = render_image(scene, options, 12);
    add_sphere(scene, 1.0, 4, true, add_dielectric(scene, Spectrum::constant(GetParam())));
    const TestImage with_sphere = render_image(scene, options, 12);
    double difference = 0.0, total = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < empty.xyz.size(); ++i) {
        difference += std::abs(with_sphere.xyz[i][1] - empty.xyz[i][1]);
        largest = std::max(largest, empty.xyz[i][1]);
        total += empty.xyz[i][1];
    }
    EXPECT_GT(largest, 0.5) << "the lights are in the picture";
    RecordProperty("difference", fmt::format("{}", difference / total));
    // eta - 1 = 1e-6 turns rays by up to 1e-3 at the sphere's rim; elsewhere by 1e-6.
    EXPECT_LT(difference, (GetParam() == 1.0 ? 1e-5 : 1e-4) * total);
}

INSTANTIATE_TEST_SUITE_P(OpticsStability, MatchedSphere, testing::Values(1.0, 1.0 + 1e-6, 1.0 - 1e-6),
                         [](const auto& test) {
                             return test.param == 1.0 ? "exactly" : test.param > 1.0 ? "above" : "below";
                         });

/// A box of glass in uniform radiance 1. What enters by a face meets only faces at the angle of that one, and others at
/// total reflection: so it leaves soon, however high the index, and all paths return the environment.
TEST(OpticsStability, BoxesOfExtremeIndicesAreInvisibleInAFurnace) {
    const double one = white()[1];
    for (const double eta : {10.0, 0.1, 1.0, 1.0 + 1e-6}) {
        Scene scene;
        scene.path = "furnace";
        scene.camera = look_at({1.5, -4, 2.5}, {0, 0, 0}, {0, 0, 1}, 34.0);
        scene.lights = {environment(Spectrum::constant(1.0))};
        add_box(scene, {-1, -1, -1}, {1, 1, 1}, false, add_dielectric(scene, Spectrum::constant(eta)));
        const TestImage image = render_image(scene, small_render("tristimulus:1", side, side, 64, 0.1, 512), 16);
        // 1/eta² and eta² are rounded once each, and so is every sum.
        for (std::size_t i = 0; i < image.xyz.size(); ++i)
            ASSERT_NEAR(image.xyz[i][1], one, 1e-5)
                << "eta " << eta << ", pixel (" << i % side << ", " << i / side << ")";
    }
}

/// From within a box of dispersive glass in radiance 1: a ray keeps its angles to the three pairs of faces, so it sees
/// radiance n² if n lets it through the pair that it meets most steeply, and nothing if all reflect it totally. The
/// camera looks along the directions in which that happens to some wavelengths and not to others.
TEST(OpticsStability, DispersiveGlassAtItsCriticalAngles) {
    constexpr int width = 8, height = 4, points = 32;
    const std::vector<double> at{300.0, 900.0}, index{1.44, 1.56}; // so that all pixels see blue
    const auto n = [&](double lambda) { return index[0] + (index[1] - index[0]) * (lambda - at[0]) / (at[1] - at[0]); };
    Scene scene;
    scene.path = "inside dispersive glass";
    const double cosine = std::sqrt(1.0 - 1.0 / (1.5 * 1.5)), across = std::sqrt(0.5) / 1.5;
    scene.camera = look_at({0, 0, 0}, {cosine, across, across}, {0, 0, 1}, 0.3);
    scene.lights = {environment(Spectrum::constant(1.0))};
    const int glass = add_dielectric(scene, Spectrum::piecewise_linear(at, index));
    add_box(scene, {-1, -1, -1}, {1, 1, 1}, false, glass);

    TestImage exact{width, height, {}};
    for (int pixel = 0; pixel < width * height; ++pixel) {
        std::vector<double> steepest;
        for (int i = 0; i < points * points; ++i) {
            const CameraRay ray = camera_ray(scene.camera, width, height, pixel % width + (i % points + 0.5) / points,
                                             pixel / width + (i / points + 0.5) / points);
            steepest.push_back(
                std::max({std::abs(ray.direction.x), std::abs(ray.direction.y), std::abs(ray.direction.z)}));
        }
        exact.xyz.push_back(integrate_xyz(Spectrum::constant(1.0), [&](double lambda) {
            const double critical2 = 1.0 - 1.0 / (n(lambda) * n(lambda));
            const auto through =
                std::count_if(steepest.begin(), steepest.end(), [&](double c) { return c * c > critical2; });
            return n(lambda) * n(lambda) * static_cast<double>(through) / (points * points);
        }));
    }
    // 144 passes visit each of the twelve slots equally often. A thousandth: the quadrature's, and paths within 1e-6 of
    // a critical angle, which outlast the depth.
    const RenderOptions options = small_render("tristimulus:4", width, height, 64, 0.1, 1024);
    expect_exact("critical_angles", render_seeds(scene, options, 144, 8), exact, {1e-3, 0.02});
}

class RoughMatched : public testing::TestWithParam<double> {};

/// The mean radiance of an image of a rough sphere of index 1 in radiance 1: facets change no direction, but those that
/// hide one another lose light, for single scattering leaves it out. G2/G1 = (1 + Λ)/(1 + 2 Λ) at each of the two
/// crossings (Heitz 2014, eqs. 72 and 99), averaged over the disc that the sphere covers of the image.
double matched_mean(double alpha) {
    constexpr int points = 10000;
    double through = 0.0;
    for (int i = 0; i < points; ++i) {
        const double sin2 = (i + 0.5) / points;
        const double lambda = 0.5 * (std::sqrt(1.0 + alpha * alpha * sin2 / (1.0 - sin2)) - 1.0);
        const double crossing = (1.0 + lambda) / (1.0 + 2.0 * lambda);
        through += crossing * crossing / points;
    }
    const double radius = 0.25 / std::tan(16.0 * pi / 180.0); // tan of the sphere's 1/√17, over that of half the field
    return 1.0 - 0.25 * pi * radius * radius * (1.0 - through);
}

/// Rough glass whose index passes through 1, and is exactly 1 over a part of the spectrum, in radiance 1. Where indices
/// match nothing may be lost or gained but by facets that hide one another and the noise of the wavelengths; at other
/// indices photons on a rough sphere (alpha 0.3) are too noisy for more than to be there.
TEST_P(RoughMatched, GainsNothing) {
    const double one = white()[1];
    const double alpha = GetParam();
    const auto nearly = [](double eta) { return Spectrum::piecewise_linear({300.0, 900.0}, {eta, eta + 1e-6}); };
    for (const Spectrum& eta : {Spectrum::piecewise_linear({300.0, 500.0, 600.0, 900.0}, {0.99, 1.0, 1.0, 1.01}),
                                nearly(1.0 + 1e-6), nearly(10.0), nearly(0.1)}) {
        Scene scene;
        scene.path = "rough";
        scene.camera = look_at({0, -4, 1}, {0, 0, 0}, {0, 0, 1}, 32.0);
        scene.lights = {environment(Spectrum::constant(1.0))};
        const int glass = add_dielectric(scene, eta);
        scene.materials[static_cast<std::size_t>(glass)].alpha_u = alpha;
        scene.materials[static_cast<std::size_t>(glass)].alpha_v = alpha;
        add_sphere(scene, 1.0, 3, true, glass);
        const TestImage image = render_image(scene, small_render("tristimulus:3", side, side, 4096, 0.1, 16), 8);
        double sum = 0.0;
        for (const Xyz& xyz : image.xyz)
            sum += xyz[1] / static_cast<double>(image.xyz.size());
        const double least = eta.minimum(300.0, 900.0);
        const double mean = sum / one;
        RecordProperty(fmt::format("mean {}", least), fmt::format("{}", mean));
        if (least > 0.9 && least < 1.1)
            EXPECT_NEAR(mean, matched_mean(alpha), 0.01) << "eta " << least;
        else if (alpha == 0.3)
            EXPECT_TRUE(mean > 0.2 && mean < 1.5) << mean << " at eta " << least;
        else
            EXPECT_TRUE(mean > 0.9 && mean < 1.03) << mean << " at eta " << least;
    }
}

INSTANTIATE_TEST_SUITE_P(OpticsStability, RoughMatched, testing::Values(0.001, 0.02, 0.3), [](const auto& test) {
    return "alpha_" + std::to_string(static_cast<int>(1000.0 * test.param)) + "e3";
});

} // namespace
} // namespace tristim::test
