// Faces that coincide, touch or leave holes, and cameras and lights inside of solids.
#include "image_statistics.h"

#include "selftest/geometry_measures.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace tristim::test {
namespace {

/// The mean and least Y of a scene under a uniform sky of radiance 1, over what the sky itself shows.
struct Seen {
    double mean = 0.0;
    double least = 0.0;
    double most = 0.0;
};

Seen under_sky(Scene scene, int max_depth = 64, int passes = 8) {
    const Spectrum constant = Spectrum::constant(1.0);
    scene.path = "sky";
    scene.lights = {environment(constant)};
    const double white = integrate_xyz(constant, [](double) { return 1.0; })[1];
    const TestImage image = render_image(scene, small_render("tristimulus:1", 32, 32, 256, 0.01, max_depth), passes);
    Seen seen{0.0, 1e30, 0.0};
    for (const Xyz& xyz : image.xyz) {
        const double y = xyz[1] / white;
        seen.mean += y / static_cast<double>(image.xyz.size());
        seen.least = std::min(seen.least, y);
        seen.most = std::max(seen.most, y);
    }
    return seen;
}

/// A square through the origin, tilted so that nothing about it is round, in n × n squares of two triangles.
void add_tilted_square(Scene& scene, double half, int n, bool up, const V3d& shift = V3d(0.0)) {
    const V3d normal = V3d(0.31, -0.22, 0.9).normalized();
    const V3d along = normal.cross(V3d(0.1, 1.0, 0.3)).normalized();
    const V3d across = normal.cross(along);
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            const double side = 2.0 * half / n;
            const V3d corner = shift + (i * side - half) * along + (j * side - half) * across;
            add_parallelogram(scene, corner, side * (up ? along : across), side * (up ? across : along), 0);
        }
    }
}

Scene tilted_scene() {
    Scene scene;
    scene.camera = look_at({0.4, -1.1, 2.3}, {0, 0, 0}, {0, 0, 1}, 20.0);
    add_diffuse(scene, Spectrum::constant(0.5));
    return scene;
}

/// A plane under a uniform sky has its reflectance as radiance, to rounding, unless shadow rays meet the plane itself.
constexpr double one_pass_rounding = 2e-5;

TEST(GeometryStability, CoincidentFacesLoseNoLight) {
    for (const bool both_up : {true, false}) {
        for (const int n : {1, 7}) {
            Scene scene = tilted_scene();
            add_tilted_square(scene, 4.0, 1, true);
            add_tilted_square(scene, 4.0, n, both_up);
            const Seen seen = under_sky(scene);
            EXPECT_NEAR(seen.least, 0.5, one_pass_rounding) << n << " squares, both up: " << both_up;
            EXPECT_NEAR(seen.most, 0.5, one_pass_rounding) << n << " squares, both up: " << both_up;
        }
    }
}

/// A small face near the origin in the plane of one twenty times as large: its rays start as far off it as its own
/// coordinates ask for, which the large one's rounding now and then exceeds. At 200 times the loss is 9 %: such faces
/// need a gap of BVH_LEAVING times the large one's coordinates.
TEST(GeometryStability, ADecalInAFloorsPlaneLosesLittleLight) {
    for (const double floor : {4.0, 40.0}) {
        Scene scene = tilted_scene();
        add_tilted_square(scene, floor, 1, true);
        add_tilted_square(scene, 2.0, 1, true);
        const Seen seen = under_sky(scene);
        RecordProperty(fmt::format("floor {} times as large", floor / 2.0), fmt::format("{:.6f}", seen.mean / 0.5));
        EXPECT_NEAR(seen.mean, 0.5, 0.5 * 1e-3) << "a floor " << floor / 2.0 << " times as large";
    }
}

/// The same with that gap, and a floor 200 times as large.
TEST(GeometryStability, ADecalJustAboveAFloorLosesNoLight) {
    constexpr double floor = 400.0;
    Scene scene = tilted_scene();
    add_tilted_square(scene, floor, 1, true);
    add_tilted_square(scene, 2.0, 1, true, V3d(0.0, 0.0, 64.0 * 0x1p-24 * floor));
    const Seen seen = under_sky(scene);
    EXPECT_NEAR(seen.least, 0.5, one_pass_rounding);
    EXPECT_NEAR(seen.most, 0.5, one_pass_rounding);
}

TEST(GeometryStability, WhichOfTwoCoincidentFacesIsMetIsTheSameEachTime) {
    const auto render = [] {
        Scene scene = tilted_scene();
        add_tilted_square(scene, 4.0, 1, true);
        const int black = add_diffuse(scene, Spectrum::constant(0.1));
        add_tilted_square(scene, 4.0, 3, true);
        for (std::size_t i = 1; i < scene.shapes.size(); ++i)
            scene.shapes[i].material = black;
        scene.path = "z-fighting";
        scene.lights = {environment(Spectrum::constant(1.0))};
        return render_image(scene, small_render("tristimulus:1", 32, 32, 256, 0.01, 4), 2).xyz;
    };
    EXPECT_EQ(render(), render());
}

/// Two glass blocks so close that they all but touch, under a uniform sky, which they must not change: each face that a
/// path crosses counts once. The gap is the least that surfaces keep apart for sure (BVH_LEAVING on both sides).
TEST(GeometryStability, GlassOnGlassWithTheLeastGapKeepsEnergy) {
    const double gap = selftest::near_gap * 0x1p-24 * 1.0;
    Scene scene;
    scene.camera = look_at({2.1, -2.7, 1.3}, {0, 0, 0}, {0, 0, 1}, 40.0);
    const int glass = add_dielectric(scene, Spectrum::constant(1.5));
    add_box(scene, {-1, -0.5, -0.5}, {-gap, 0.5, 0.5}, false, glass);
    add_box(scene, {0, -0.5, -0.5}, {1, 0.5, 0.5}, false, glass);
    const Seen seen = under_sky(scene, 256);
    EXPECT_NEAR(seen.least, 1.0, one_pass_rounding);
    EXPECT_NEAR(seen.most, 1.0, one_pass_rounding);
}

/// Inside glass of index n radiance is n² times that outside (Veach 1997, section 5.2).
TEST(GeometryStability, ACameraInsideGlassSeesTheSkyTimesTheIndexSquared) {
    Scene scene;
    scene.camera = look_at({0, 0, 0}, {1, 0.1, 0.2}, {0, 0, 1}, 60.0);
    add_sphere(scene, 0.5, 4, false, add_dielectric(scene, Spectrum::constant(1.5)));
    const Seen seen = under_sky(scene);
    EXPECT_NEAR(seen.least, 2.25, 1e-4);
    EXPECT_NEAR(seen.most, 2.25, 1e-4);
}

/// From its middle a ball of glass lets light out as if it were not there: what is reflected inside comes out later.
TEST(GeometryStability, ALightInsideGlassLightsTheFloorAsIfThereWereNoGlass) {
    using std::numbers::pi;
    constexpr int width = 8, height = 8, passes = 16;
    constexpr double radius = 0.08;
    const Spectrum white = Spectrum::constant(1.0);
    Scene scene;
    scene.path = "light in glass";
    scene.camera = look_at({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 12.0);
    scene.camera.camera_to_world[3][0] = 0.6; // past the ball
    add_horizontal_square(scene, 4.0, 0.0, true, add_diffuse(scene, Spectrum::constant(0.5)));
    add_sphere(scene, 0.125, 5, false, add_dielectric(scene, Spectrum::constant(1.5)));
    for (V3d& position : scene.shapes.back().mesh.positions)
        position += V3d(0, 0, 0.75);
    Light light;
    light.emission = white;
    light.position = {0, 0, 0.75};
    scene.lights = {light};
    const Xyz of_white = integrate_xyz(white, [](double) { return 1.0; });
    TestImage exact{width, height, {}};
    for (int pixel = 0; pixel < width * height; ++pixel) {
        const double e =
            pixel_mean(scene.camera, width, height, pixel % width, pixel / width, [&](const CameraRay& ray) {
                const V3d p = at_height(ray, 0.0);
                return disc_mean(mean_squared_radius(radius, passes), [&](double dx, double dy) {
                    const V3d towards = light.position - (p + V3d(dx, dy, 0.0));
                    return towards.z / std::pow(towards.length(), 3.0);
                });
            });
        exact.xyz.push_back({});
        for (std::size_t c = 0; c < 3; ++c)
            exact.xyz.back()[c] = 0.5 / pi * e * of_white[c];
    }
    // Facets of 1/32 of the radius turn light by up to half a degree: some thousandths where the irradiance falls off.
    expect_exact("light-in-glass",
                 render_seeds(scene, small_render("tristimulus:1", width, height, 32768, radius, 8), passes, 5), exact,
                 {0.01, 0.01});
}

/// A box one of whose sides is cut where the neighbours' edges are not: the new vertices are rounded off the edges.
/// Those cracks are in the mesh; they are so narrow that only rays aimed at them get out.
TEST(GeometryStability, TJunctionsLeakOnlyWhatIsAimedAtThem) {
    using namespace selftest;
    const Device& device = test_device();
    const GeometryKernels kernels({device, false, 1.0});
    const auto turned = [](const V3d& p) { // so that edges are not along the axes, where rounding would be exact
        const M44d turn = M44d().setAxisAngle(V3d(1.0, 2.0, 3.0).normalized(), 0.7);
        return V3f(p * turn);
    };
    TriangleSoup soup;
    const TriangleSoup box = closed_mesh("box", 1.0, V3d(0.0));
    std::vector<std::array<V3f, 2>> cut_edges;
    for (std::size_t i = 0; i < box.v0.size(); ++i) {
        const Corners c = corners_of(box, i);
        const V3d v0(c.v0), v1(c.v1), v2(c.v2);
        if (v0.x != 1.0 || v1.x != 1.0 || v2.x != 1.0) {
            add(soup, {turned(v0), turned(v1), turned(v2)});
            continue;
        }
        constexpr int cuts = 10; // a fan from v0, cut along the side v1 v2 and not along the others
        for (int k = 0; k < cuts; ++k) {
            const V3d a = v1 + k / double{cuts} * (v2 - v1), b = v1 + (k + 1) / double{cuts} * (v2 - v1);
            add(soup, {turned(v0), turned(a), turned(b)});
            cut_edges.push_back({turned(a), turned(b)});
        }
    }
    const GeometryMesh mesh(device, soup);
    selftest::Random random(9);
    std::vector<Ray> anywhere, at_cracks;
    for (int i = 0; i < 1 << 19; ++i) {
        const V3f origin(random.in_cube(0.4));
        anywhere.push_back(ray_along(origin, random.direction()));
        const auto& edge = cut_edges[random.index(cut_edges.size())];
        const auto s = static_cast<float>(random());
        at_cracks.push_back(ray_through(origin, (1.0F - s) * edge[0] + s * edge[1]));
    }
    const auto leaked = [&](const std::vector<Ray>& rays) {
        std::size_t count = 0;
        for (const RayHit& hit : kernels.closest(mesh, rays))
            count += hit.triangle < 0 ? 1 : 0;
        return count;
    };
    // Cracks are as wide as the vertices round, 2^-24, of faces as wide as 1.
    EXPECT_LE(leaked(anywhere), 1U);
    const std::size_t through_cracks = leaked(at_cracks);
    RecordProperty("rays aimed at cracks that leaked", fmt::format("{} of {}", through_cracks, at_cracks.size()));
    EXPECT_GT(through_cracks, 0U) << "no crack at all: the test tests nothing";
    EXPECT_LT(through_cracks, at_cracks.size() / 2);
}

} // namespace
} // namespace tristim::test
