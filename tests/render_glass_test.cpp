// Light through glass, seen through glass: every combination of visible points and photons that carry all wavelengths
// of a pass or one alone.
#include "image_statistics.h"
#include "method_cases.h"

#include <cmath>
#include <numbers>

namespace tristim::test {
namespace {

using std::numbers::pi;

Spectrum coloured_reflectance() {
    return Spectrum::piecewise_linear({300.0, 420.0, 520.0, 620.0, 900.0}, {0.2, 0.3, 0.7, 0.45, 0.8});
}

/// A slab whose index is 1 but for some 10⁻⁶ that depend on the wavelength: paths keep one wavelength there, and
/// nothing else happens. It hangs over a part of the floor, between two lights. The camera sees the floor past its
/// edge, through it and beside it, where light from above comes through the slab and light from below does not.
class GhostGlass : public testing::TestWithParam<MethodCase> {};

TEST_P(GhostGlass, ShowsTheFloorAsIfItWereNotThere) {
    constexpr int width = 8;
    constexpr int height = 4;
    constexpr double radius = 0.12;
    constexpr int passes = 30;
    const Spectrum d65 = Spectrum::named("stdillum-D65");
    const Spectrum reflectance = coloured_reflectance();
    Scene scene;
    scene.path = "ghost";
    scene.camera = look_at({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 10.0);
    add_horizontal_square(scene, 3.0, 0.0, true, add_diffuse(scene, reflectance));
    const int ghost = add_dielectric(scene, Spectrum::piecewise_linear({300.0, 900.0}, {1.000002, 1.000001}));
    add_parallelogram(scene, {-3, -3, 1.0}, {3, 0, 0}, {0, 6, 0}, ghost);
    add_parallelogram(scene, {-3, -3, 0.8}, {0, 6, 0}, {3, 0, 0}, ghost);
    scene.lights.resize(2);
    for (Light& light : scene.lights) {
        light.kind = Light::Kind::Point;
        light.emission = d65;
    }
    scene.lights[0].position = {0.2, 0.4, 0.7};
    scene.lights[0].scale = 1.0;
    // The slab's edge shades it beyond x = 0.5, out of sight.
    scene.lights[1].position = {-0.5, 0.2, 2.0};
    scene.lights[1].scale = 8.0;

    const Xyz white = integrate_xyz(d65, [&](double lambda) { return reflectance(lambda) / pi; });
    const double squared_radius = mean_squared_radius(radius, passes);
    TestImage exact{width, height, {}};
    for (int pixel = 0; pixel < width * height; ++pixel) {
        const double e =
            pixel_mean(scene.camera, width, height, pixel % width, pixel / width, [&](const CameraRay& ray) {
                const V3d p = at_height(ray, 0.0);
                const auto irradiance = [&](std::size_t light, bool by_photons) {
                    return disc_mean(by_photons ? squared_radius : 0.0, [&](double dx, double dy) {
                        const V3d towards = scene.lights[light].position - (p + V3d(dx, dy, 0.0));
                        return scene.lights[light].scale * towards.z / std::pow(towards.length(), 3.0);
                    });
                };
                return irradiance(0, GetParam().direct_photons) + irradiance(1, true);
            });
        exact.xyz.push_back({e * white[0], e * white[1], e * white[2]});
    }
    RenderOptions options = small_render(GetParam().method, width, height, 32768, radius, 8);
    options.direct_photons = GetParam().direct_photons;
    expect_exact("ghost-" + method_case_name({GetParam(), 0}), render_seeds(scene, options, passes, 6), exact,
                 {1e-4, 0.06});
}

INSTANTIATE_TEST_SUITE_P(Methods, GhostGlass,
                         testing::Values(MethodCase{"tristimulus:1", false}, MethodCase{"tristimulus:1", true},
                                         MethodCase{"tristimulus:5", false}, MethodCase{"tristimulus:5", true}),
                         method_case_name);

/// Fresnel reflectance for unpolarised light from vacuum (Born & Wolf 1999, section 1.5.2).
double fresnel(double cos_i, double eta) {
    const double cos_t = std::sqrt(1.0 - (1.0 - cos_i * cos_i) / (eta * eta));
    const double s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    const double p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    return 0.5 * (s * s + p * p);
}

/// What a plane-parallel plate reflects, both faces and all orders between them added: 2R/(1 + R).
double plate_reflectance(double cos_i, double eta) {
    const double r = fresnel(cos_i, eta);
    return 2.0 * r / (1.0 + r);
}

/// The same for diffuse light, ∫ R 2 cos θ sin θ dθ by the midpoint rule in cos²θ.
double diffuse_plate_reflectance(double eta) {
    constexpr int points = 256;
    double sum = 0.0;
    for (int i = 0; i < points; ++i)
        sum += plate_reflectance(std::sqrt((i + 0.5) / points), eta) / points;
    return sum;
}

/// A plate of glass close over a diffuse floor, both so large that their edges are out of reach.
struct CoveredFloor {
    Scene scene;
    Spectrum reflectance = coloured_reflectance();

    CoveredFloor(const Spectrum& eta, const Light& light, double half_side) {
        scene.path = "covered floor";
        scene.camera = look_at({0, -2, 2}, {0, 0, 0}, {0, 0, 1}, 30.0);
        add_horizontal_square(scene, half_side, 0.0, true, add_diffuse(scene, reflectance));
        const int glass = add_dielectric(scene, eta);
        add_horizontal_square(scene, half_side, 0.2, true, glass);
        add_horizontal_square(scene, half_side, 0.1, false, glass);
        scene.lights = {light};
    }
};

/// Under a uniform environment of radiance 1 the floor has the radiance ρ T / (1 − ρ (1 − T)), T the plate's diffuse
/// transmittance, and the plate adds what it reflects: energy balance, for each wavelength.
TEST(CoveredFloor, HasTheRadianceOfTheEnergyBalance) {
    constexpr int width = 4;
    constexpr int height = 4;
    Light sky;
    sky.kind = Light::Kind::Infinite;
    sky.emission = Spectrum::named("stdillum-D65");
    struct Plate {
        const char* name;
        Spectrum eta;
        const char* method;
        bool direct_photons;
        bool from_below;
    };
    const Spectrum plain = Spectrum::constant(1.6);
    const Spectrum flint = Spectrum::named("glass-F11");
    for (const Plate& plate : {Plate{"plain", plain, "tristimulus:1", false, false},
                               Plate{"flint-sample", flint, "tristimulus:1", false, false},
                               Plate{"flint-photons", flint, "tristimulus:4", true, false},
                               Plate{"flint-below-tristimulus:1", flint, "tristimulus:1", false, true},
                               Plate{"flint-below-spectral:400", flint, "spectral:400", false, true}}) {
        CoveredFloor floor(plate.eta, sky, 8.0);
        if (plate.from_below) // between plate and floor: single-wavelength photons at points of all wavelengths
            floor.scene.camera = look_at({0, -0.05, 0.08}, {0, 0, 0}, {0, 0, 1}, 30.0);
        TestImage exact{width, height, {}};
        for (int pixel = 0; pixel < width * height; ++pixel) {
            exact.xyz.push_back(integrate_xyz(sky.emission, [&](double lambda) {
                const double eta = plate.eta(lambda);
                const double reflected = diffuse_plate_reflectance(eta);
                const double rho = floor.reflectance(lambda);
                const double radiance = rho * (1.0 - reflected) / (1.0 - rho * reflected);
                const auto seen = [&](const CameraRay& ray) {
                    const double r = plate.from_below ? 0.0 : plate_reflectance(-ray.direction.z, eta);
                    return r + (1.0 - r) * radiance;
                };
                const int x = pixel % width;
                const int y = pixel / width;
                return seen(camera_ray(floor.scene.camera, width, height, x + 0.5, y + 0.5));
            }));
        }
        RenderOptions options = small_render(plate.method, width, height, 16384, 1.5, 64);
        options.direct_photons = plate.direct_photons;
        // Edges: the floor sees past the plate's edge, 8 away at a height of 0.2, (0.2/6)² of the sky at most.
        expect_exact(std::string("covered-floor-") + plate.name, render_seeds(floor.scene, options, 12, 6), exact,
                     {1.2e-3, 0.07});
    }
}

} // namespace
} // namespace tristim::test
