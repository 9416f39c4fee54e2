// Smooth conductors, seen by the camera and met by photons: exact radiance by Fresnel's equations.
#include "image_statistics.h"

#include <cmath>
#include <complex>
#include <numbers>

namespace tristim::test {
namespace {

/// Unpolarised Fresnel reflectance of an interface from vacuum to a complex index (Born & Wolf 1999, section 14.2), by
/// complex arithmetic.
double fresnel(double cos_i, std::complex<double> index) {
    const std::complex<double> cos_t = std::sqrt(1.0 - (1.0 - cos_i * cos_i) / (index * index));
    const std::complex<double> s = (cos_i - index * cos_t) / (cos_i + index * cos_t);
    const std::complex<double> p = (index * cos_i - cos_t) / (index * cos_i + cos_t);
    return 0.5 * (std::norm(s) + std::norm(p));
}

/// A mirror of gold under a uniform environment: R(θ, λ) at each pixel.
TEST(ConductorMirror, ReflectsTheEnvironmentByFresnel) {
    const Spectrum light = Spectrum::named("stdillum-A");
    const Spectrum eta = Spectrum::named("metal-Au-eta");
    const Spectrum k = Spectrum::named("metal-Au-k");
    Scene scene;
    scene.path = "mirror";
    // From steep to grazing angles.
    scene.camera = look_at({0, -3, 1.6}, {0, 0, 0}, {0, 0, 1}, 12.0);
    scene.lights = {environment(light)};
    add_horizontal_square(scene, 100.0, 0.0, true, add_conductor(scene, eta, k));
    constexpr int width = 2;
    constexpr int height = 8;
    TestImage exact{width, height, {}};
    for (int pixel = 0; pixel < width * height; ++pixel) {
        exact.xyz.push_back(integrate_xyz(light, [&](double lambda) {
            return pixel_mean(scene.camera, width, height, pixel % width, pixel / width, [&](const CameraRay& ray) {
                return fresnel(-ray.direction.z, {eta(lambda), k(lambda)});
            });
        }));
    }
    // The kernels read the metal's data at bin means joined by lines: 1e-4 covers the corners of its table.
    for (const char* method : {"tristimulus:1", "tristimulus:20", "spectral:400"})
        expect_exact(std::string("mirror-") + method,
                     render_seeds(scene, small_render(method, width, height, 64, 0.1, 4), 64, 8), exact, {1e-4, 0.01});
}

struct View {
    const char* name;
    V3d eye, target;
    bool into_mirror;
};

class GoldMirror : public testing::TestWithParam<View> {};

/// A floor before a mirror of gold, the plane x = 0, lit by a point: straight, and as if from the light's image behind
/// the mirror, dimmed by R(θ, λ). Seen directly, and in the mirror, which dims it once more.
TEST_P(GoldMirror, LightsTheFloorAndShowsIt) {
    constexpr int width = 4;
    constexpr int height = 4;
    constexpr int passes = 24;
    constexpr double radius = 0.08;
    const Spectrum d65 = Spectrum::named("stdillum-D65");
    const Spectrum eta = Spectrum::named("metal-Au-eta");
    const Spectrum k = Spectrum::named("metal-Au-k");
    const Spectrum reflectance = Spectrum::piecewise_linear({300.0, 480.0, 600.0, 900.0}, {0.3, 0.4, 0.7, 0.6});
    Scene scene;
    scene.path = "gold";
    scene.camera = look_at(GetParam().eye, GetParam().target, {0, 0, 1}, 16.0);
    add_horizontal_square(scene, 3.0, 0.0, true, add_diffuse(scene, reflectance));
    add_parallelogram(scene, {0, -3, 0}, {0, 6, 0}, {0, 0, 4}, add_conductor(scene, eta, k));
    scene.lights.resize(1);
    Light& light = scene.lights.front();
    light.kind = Light::Kind::Point;
    light.emission = d65;
    light.position = {0.7, -0.2, 1.0};
    light.scale = 3.0;
    const V3d image = {-light.position.x, light.position.y, light.position.z};

    for (const bool direct_photons : {false, true}) {
        const double squared_radius = mean_squared_radius(radius, passes);
        const auto irradiance = [&](const V3d& from, const V3d& p, bool by_photons) {
            return disc_mean(by_photons ? squared_radius : 0.0, [&](double dx, double dy) {
                const V3d towards = from - (p + V3d(dx, dy, 0.0));
                return light.scale * towards.z / std::pow(towards.length(), 3.0);
            });
        };
        TestImage exact{width, height, {}};
        for (int pixel = 0; pixel < width * height; ++pixel) {
            exact.xyz.push_back(integrate_xyz(d65, [&](double lambda) {
                const std::complex<double> index(eta(lambda), k(lambda));
                const auto radiance = [&](const CameraRay& ray) {
                    CameraRay seen = ray;
                    double dimmed = 1.0;
                    if (GetParam().into_mirror) { // mirrored, the ray starts behind the mirror
                        dimmed = fresnel(std::abs(ray.direction.x), index);
                        seen.origin.x = -seen.origin.x;
                        seen.direction.x = -seen.direction.x;
                    }
                    const V3d p = at_height(seen, 0.0);
                    const V3d towards = (image - p).normalized();
                    return dimmed * reflectance(lambda) / std::numbers::pi *
                           (irradiance(light.position, p, direct_photons) +
                            irradiance(image, p, true) * fresnel(std::abs(towards.x), index));
                };
                return radiance(camera_ray(scene.camera, width, height, pixel % width + 0.5, pixel / width + 0.5));
            }));
        }
        RenderOptions options = small_render("tristimulus:2", width, height, 16384, radius, 6);
        options.direct_photons = direct_photons;
        // Radiance at the middle of a pixel stands for its mean: 2e-3 covers the curvature over its 0.1 units.
        expect_exact(std::string("gold-") + GetParam().name + (direct_photons ? "-photons" : "-sample"),
                     render_seeds(scene, options, passes, 6), exact, {2e-3, 0.02});
    }
}

INSTANTIATE_TEST_SUITE_P(Views, GoldMirror,
                         testing::Values(View{"floor", {1.2, -1.5, 1.5}, {0.8, 0.0, 0.0}, false},
                                         View{"mirror", {1.5, -1.2, 1.2}, {-0.8, 0.1, 0.0}, true}),
                         [](const testing::TestParamInfo<View>& view) { return std::string(view.param.name); });

} // namespace
} // namespace tristim::test
