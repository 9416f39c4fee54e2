// Light that photons carry to where none is: through walls, slabs and round corners. It may come from within a search
// radius, where surfaces face alike, and from nowhere else.

#include "render/renderer.h"
#include "test_scenes.h"

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numeric>

namespace tristim::test::leaks_test {
namespace {

constexpr int side = 16;

/// Mean Y of an image of photons alone, searched with this radius throughout; every pixel in *pixels if given.
double mean_of_photons(const Scene& scene, double radius, int photons, int max_depth,
                       std::vector<double>* pixels = nullptr) {
    RenderOptions options = small_render("tristimulus:1", side, side, photons, radius, max_depth);
    options.direct_photons = true;
    Renderer renderer(scene, options, test_device());
    for (std::uint32_t pass = 0; pass < 8; ++pass)
        renderer.render_pass({pass, 0, 0, 0});
    const FilmImage film = renderer.film();
    EXPECT_EQ(film.rejected_samples, 0U);
    std::vector<double> values;
    for (const auto& xyz : film.xyz)
        values.push_back(xyz[1]);
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    if (pixels != nullptr)
        *pixels = values;
    return mean;
}

void add_point_light(Scene& scene, const V3d& position) {
    Light light;
    light.kind = Light::Kind::Point;
    light.emission = Spectrum::constant(1.0);
    light.position = position;
    scene.lights.push_back(light);
}

/// Two closed rooms, their floors in one plane, a wall of a thickness between them: one is lit, the camera in the other
/// looks down at a square of floor along the wall, `seen` wide.
Scene two_rooms(double thickness, double seen) {
    Scene scene;
    const double half = 0.5 * thickness;
    const int grey = add_diffuse(scene, Spectrum::constant(0.5));
    add_box(scene, {-2, -1, 0}, {-half, 1, 2}, true, grey);
    add_box(scene, {half, -1, 0}, {2, 1, 2}, true, grey);
    add_point_light(scene, {-half - 0.5, 0, 1});
    const double height = 1.5;
    scene.camera = look_at({half + 0.5 * seen, 0, height}, {half + 0.5 * seen, 0, 0}, {0, 1, 0},
                           2.0 * std::atan(0.5 * seen / height) * 180.0 / 3.14159265358979);
    return scene;
}

TEST(PhotonStability, NoLightPassesAWallThickerThanTheRadius) {
    constexpr double radius = 0.1;
    EXPECT_EQ(mean_of_photons(two_rooms(radius * 1.01, 0.4), radius, 16384, 8), 0.0);
    EXPECT_EQ(mean_of_photons(two_rooms(1e-3, 0.4), 0.99e-3, 16384, 8), 0.0);
    EXPECT_GT(mean_of_photons(two_rooms(0.5 * radius, 0.4), radius, 16384, 8), 0.0) << "the test sees no leak at all";
}

/// A wall without thickness leaks what lies within r of it: a strip of floor of which the share is proportional to r.
TEST(PhotonStability, WhatAThinWallLeaksFallsWithTheRadius) {
    const Scene scene = two_rooms(0.0, 0.4);
    std::vector<double> leaked;
    for (const double radius : {0.2, 0.1, 0.05}) {
        std::vector<double> pixels;
        leaked.push_back(mean_of_photons(scene, radius, 131072, 8, &pixels));
        // Nothing beyond the radius: columns of pixels run away from the wall.
        for (int y = 0; y < side; ++y) {
            for (int x = 0; x < side; ++x) {
                if (0.4 * x / side > radius) {
                    EXPECT_EQ(pixels[static_cast<std::size_t>(y * side + x)], 0.0)
                        << radius << " at " << x << ", " << y;
                }
            }
        }
    }
    // Photons thousands, so noise of a few per cent; the floor's light falls off from the wall by less than that within
    // r.
    EXPECT_NEAR(leaked[1] / leaked[0], 0.5, 0.06);
    EXPECT_NEAR(leaked[2] / leaked[1], 0.5, 0.06);
}

/// The side of a block next to its lit top, and the bottom of a thin slab below it: the surfaces face elsewhere, so
/// nothing leaks whatever the radius.
TEST(PhotonStability, NoLightTurnsARightAngleOrPassesASlab) {
    constexpr double radius = 0.3;
    for (const double thickness : {1.0, 1e-3, 1e-6}) {
        Scene scene;
        add_box(scene, {-1, -1, -thickness}, {1, 1, 0}, false, add_diffuse(scene, Spectrum::constant(0.5)));
        add_point_light(scene, {0, 0, 2});
        scene.camera = look_at({0, 0, -2}, {0, 0, 0}, {0, 1, 0}, 40.0);
        EXPECT_EQ(mean_of_photons(scene, radius, 65536, 4), 0.0) << "below a slab " << thickness << " thick";
        scene.camera = look_at({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 40.0);
        EXPECT_GT(mean_of_photons(scene, radius, 65536, 4), 0.0) << "above it";
        if (thickness < 1.0)
            continue;
        scene.camera = look_at({4, 0, -0.2}, {1, 0, -0.2}, {0, 0, 1}, 5.0);
        EXPECT_EQ(mean_of_photons(scene, radius, 65536, 4), 0.0) << "beside it";
    }
}

/// Round an edge whose faces turn by less than 60° photons do count: the shadow side of a shallow roof gets light
/// within r of its ridge, in proportion to r.
TEST(PhotonStability, WhatAShallowRidgeLeaksFallsWithTheRadius) {
    Scene scene;
    const int grey = add_diffuse(scene, Spectrum::constant(0.5));
    const double slope = std::tan(25.0 * 3.14159265358979 / 180.0);
    add_parallelogram(scene, {-1, -1, -slope}, {1, 0, slope}, {0, 2, 0}, grey); // towards -x, lit
    add_parallelogram(scene, {0, -1, 0}, {1, 0, -slope}, {0, 2, 0}, grey);      // towards +x, in shadow
    add_point_light(scene, {-3, 0, 1.0});                                       // below the plane of the right half
    const V3d normal = V3d(slope, 0, 1).normalized();
    const V3d seen = V3d(0.2, 0, -0.2 * slope);
    scene.camera = look_at(seen + 2.0 * normal, seen, {0, 1, 0}, 8.0);
    const double wide = mean_of_photons(scene, 0.2, 262144, 1);
    const double narrow = mean_of_photons(scene, 0.1, 262144, 1);
    EXPECT_GT(narrow, 0.0);
    // The part of the roof that is seen begins some way from the ridge, so that it falls faster than r.
    EXPECT_LT(narrow, 0.55 * wide);
    EXPECT_EQ(mean_of_photons(scene, 0.05, 262144, 1), 0.0);
}

} // namespace
} // namespace tristim::test::leaks_test
