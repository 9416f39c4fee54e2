// A diffuse plane under every kind of light: exact radiance, by sampled direct light and by photons alone.
#include "image_statistics.h"
#include "method_cases.h"

#include <cmath>
#include <numbers>

namespace tristim::test {
namespace {

using std::numbers::pi;

constexpr int width = 8;
constexpr int height = 6;
constexpr double plane_half_side = 3.0;

/// Smoothly coloured, so that wavelengths matter.
Spectrum coloured_reflectance() {
    return Spectrum::piecewise_linear({300.0, 450.0, 560.0, 640.0, 900.0}, {0.25, 0.3, 0.65, 0.55, 0.7});
}

/// The lights that shine: one of each kind, or all of them together.
enum LightIndex : std::size_t { Distant, Point, Spot, Area, Together };

/// The plane z = 0 and D65 lights. Those that do not shine keep their place, so that all cases run the same kernels.
Scene plane_scene(LightIndex shining, const Spectrum& reflectance) {
    Scene scene;
    scene.path = "plane";
    scene.camera = look_at({0.4, -2.0, 2.5}, {0.1, 0.2, 0.0}, {0.0, 0.0, 1.0}, 25.0);
    add_horizontal_square(scene, plane_half_side, 0.0, true, add_diffuse(scene, reflectance));
    scene.lights.resize(Area);

    Light& distant = scene.lights[Distant];
    distant.kind = Light::Kind::Distant;
    distant.direction = V3d(0.3, 0.4, -1.2).normalized();
    // Scales such that every light is chosen in several of the passes: pixels are near enough to normal then.
    distant.scale = 0.7;
    Light& point = scene.lights[Point];
    point.kind = Light::Kind::Point;
    point.position = {-0.6, 0.7, 1.1};
    point.scale = 3.0;
    Light& spot = scene.lights[Spot];
    spot.kind = Light::Kind::Spot;
    spot.position = {0.9, 0.8, 1.9};
    spot.direction = (V3d(0.1, 0.1, 0.0) - spot.position).normalized();
    // The falloff crosses the image.
    spot.cos_total_width = std::cos(30.0 * pi / 180.0);
    spot.cos_falloff_start = std::cos(3.0 * pi / 180.0);
    spot.scale = 60.0;

    const int area = add_area_light(scene, Spectrum::constant(1.0), 20.0);
    // Shines down: its normal is -z.
    add_parallelogram(scene, {1.2, 0.3, 1.3}, {0.0, 0.6, 0.0}, {0.8, 0.0, 0.0},
                      add_diffuse(scene, Spectrum::constant(0.0)), area);
    for (std::size_t i = 0; i < scene.lights.size(); ++i) {
        scene.lights[i].emission = Spectrum::named("stdillum-D65");
        if (shining != Together && i != shining)
            scene.lights[i].scale = 0.0;
    }
    return scene;
}

/// E at a point of the plane: intensity · cos / d² (CIE S 017: inverse square law).
double irradiance_by_point(const V3d& light, double intensity, const V3d& p) {
    const V3d towards = light - p;
    return intensity * towards.z / std::pow(towards.length(), 3.0);
}

/// pbrt-v4's SpotLight: smoothstep between the cosines.
double irradiance_by_spot(const Light& light, const V3d& p) {
    const double cosine = (p - light.position).normalized().dot(light.direction);
    const double x =
        std::clamp((cosine - light.cos_total_width) / (light.cos_falloff_start - light.cos_total_width), 0.0, 1.0);
    return irradiance_by_point(light.position, light.scale * x * x * (3.0 - 2.0 * x), p);
}

/// Lambert's formula for a polygon of uniform radiance seen from a point with normal +z, the polygon above the plane:
/// E = L/2 Σ Γ_i (n · unit(r_i × r_{i+1})), Γ_i the angle between consecutive corners.
double irradiance_by_polygon(const std::vector<V3d>& corners, double radiance, const V3d& p) {
    double sum = 0.0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const V3d a = (corners[i] - p).normalized();
        const V3d b = (corners[(i + 1) % corners.size()] - p).normalized();
        sum += std::acos(a.dot(b)) * a.cross(b).normalized().z;
    }
    return 0.5 * radiance * std::abs(sum);
}

std::vector<V3d> area_light_corners() {
    return {{1.2, 0.3, 1.3}, {1.2, 0.9, 1.3}, {2.0, 0.9, 1.3}, {2.0, 0.3, 1.3}};
}

double irradiance(const Scene& scene, const V3d& p) {
    return -scene.lights[Distant].scale * scene.lights[Distant].direction.z +
           irradiance_by_point(scene.lights[Point].position, scene.lights[Point].scale, p) +
           irradiance_by_spot(scene.lights[Spot], p) +
           irradiance_by_polygon(area_light_corners(), scene.lights[Area].scale, p);
}

/// E ρ/π of every pixel; photons see E through a disc of the search's mean squared radius.
TestImage exact_image(const Scene& scene, const Spectrum& reflectance, double squared_radius) {
    const Xyz white =
        integrate_xyz(scene.lights.front().emission, [&](double lambda) { return reflectance(lambda) / pi; });
    TestImage image{width, height, {}};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double e = pixel_mean(scene.camera, width, height, x, y, [&](const CameraRay& ray) {
                const V3d p = at_height(ray, 0.0);
                return disc_mean(squared_radius,
                                 [&](double dx, double dy) { return irradiance(scene, p + V3d(dx, dy, 0.0)); });
            });
            image.xyz.push_back({e * white[0], e * white[1], e * white[2]});
        }
    }
    return image;
}

class LitPlane : public testing::TestWithParam<MethodCase> {};

TEST_P(LitPlane, HasTheExactRadiance) {
    if (std::string(GetParam().method) == "tristimulus:20" && !long_tests())
        GTEST_SKIP() << "set TRISTIM_LONG_TESTS=1";
    const bool rgb = std::string(GetParam().method) == "rgb"; // exact for grey surfaces only
    const Spectrum reflectance = rgb ? Spectrum::constant(0.6) : coloured_reflectance();
    constexpr double radius = 0.1;
    constexpr int passes = 48;
    constexpr int runs = 8;
    // How lights are sampled does not depend on the method: one of them serves to tell the lights apart.
    const bool each = std::string(GetParam().method) == "tristimulus:1";
    const std::vector<LightIndex> lights =
        each ? std::vector{Distant, Point, Spot, Area, Together} : std::vector{Together};
    for (const LightIndex shining : lights) {
        const Scene scene = plane_scene(shining, reflectance);
        RenderOptions options = small_render(GetParam().method, width, height, 8192, radius, 4);
        options.direct_photons = GetParam().direct_photons;
        const double squared_radius = options.direct_photons ? mean_squared_radius(radius, passes) : 0.0;
        const std::string light = std::array{"distant", "point", "spot", "area", "together"}[shining];
        expect_exact("plane-" + light + "-" + method_case_name({GetParam(), 0}),
                     render_seeds(scene, options, passes, runs), exact_image(scene, reflectance, squared_radius),
                     {2e-5, 0.02});
    }
}

INSTANTIATE_TEST_SUITE_P(Methods, LitPlane,
                         testing::Values(MethodCase{"tristimulus:1", false}, MethodCase{"tristimulus:1", true},
                                         MethodCase{"tristimulus:20", false}, MethodCase{"tristimulus:20", true},
                                         MethodCase{"spectral:400", false}, MethodCase{"spectral:400", true},
                                         MethodCase{"rgb", false}, MethodCase{"rgb", true}),
                         method_case_name);

/// The oracle's own oracle: Lambert's formula against quadrature of L cos cos' / d² over the light.
TEST(LitPlaneOracle, PolygonFormulaAgreesWithQuadrature) {
    const std::vector<V3d> corners = area_light_corners();
    const V3d p(0.37, -0.21, 0.0);
    constexpr int n = 400;
    double sum = 0.0;
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            const V3d q =
                corners[0] + (i + 0.5) / n * (corners[1] - corners[0]) + (j + 0.5) / n * (corners[3] - corners[0]);
            const V3d d = q - p;
            sum += d.z * d.z / (d.dot(d) * d.dot(d));
        }
    }
    const double area = (corners[1] - corners[0]).cross(corners[3] - corners[0]).length();
    // The midpoint rule's error is below 1/n² times a second derivative of order one.
    EXPECT_NEAR(irradiance_by_polygon(corners, 1.0, p), sum * area / (n * n), 1e-5);
}

TEST(StudentsT, HasItsTabulatedPercentiles) {
    EXPECT_NEAR(student_p_value(2.228139, 10.0), 0.05, 1e-6);
    EXPECT_NEAR(student_p_value(5.408, 7.0), 0.001, 1e-6);
    EXPECT_NEAR(student_p_value(-1.0, 1.0), 0.5, 1e-12);
}

} // namespace
} // namespace tristim::test
