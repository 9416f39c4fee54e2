// Rough conductors and dielectrics, with and without films: camera and photon paths against each other.

#include "image_statistics.h"
#include "rough_surfaces.h"

namespace tristim::test {
namespace {

enum class LightKind { Point, Area };
struct Consistency {
    const char* name;
    RoughSurface surface;
    LightKind light;
    bool behind; ///< the light stands behind the surface, which is a slab's face then
};

void light_from(Scene& scene, LightKind kind, const V3d& at) {
    if (kind == LightKind::Point) {
        scene.lights.push_back(point_light(at, 3.0));
        return;
    }
    const int light = add_area_light(scene, Spectrum::named("stdillum-D65"), 4.0);
    // Facing the surface at z = 0.
    const double sign = at.z > 0.0 ? -1.0 : 1.0;
    add_parallelogram(scene, at - V3d(0.4, 0.4, 0.0), sign > 0.0 ? V3d(0.8, 0, 0) : V3d(0, 0.8, 0),
                      sign > 0.0 ? V3d(0, 0.8, 0) : V3d(0.8, 0, 0), add_diffuse(scene, Spectrum::constant(0.0)), light);
}

class DirectLight : public testing::TestWithParam<Consistency> {};

/// A rough sheet lit by sampling the light, and by photons that the sheet takes: one flux, one BSDF.
TEST_P(DirectLight, SampledAndByPhotonsIsTheSame) {
    if (std::string(GetParam().name) == "glass_area" && !long_tests())
        GTEST_SKIP() << "set TRISTIM_LONG_TESTS=1";
    constexpr int width = 4, height = 4;
    Scene scene;
    scene.path = "rough";
    scene.camera = look_at({0.3, -1.6, 1.5}, {0, 0, 0}, {0, 0, 1}, 14.0);
    add_square_with_uv(scene, 1.2, add_rough(scene, GetParam().surface));
    light_from(scene, GetParam().light, GetParam().behind ? V3d(-0.1, 0.6, -1.2) : V3d(-0.1, 1.0, 1.2));
    RenderOptions options = small_render("tristimulus:1", width, height, 16384, 0.05, 6);
    const RenderSet sampled = render_seeds(scene, options, 64, 4);
    options.direct_photons = true;
    const RenderSet photons = render_seeds(scene, options, 32, 4);
    // The mean over a disc of radius 0.05 at distances about 1.4 from light and camera, of a lobe some α wide: 6e-3.
    expect_same(GetParam().name, photons, sampled, {6e-3, 0.03});
}

constexpr RoughSurface coated_gold{"coated_gold", true, true, 0.25, 0.5}, glass{"glass", false, false, 0.3, 0.3};
INSTANTIATE_TEST_SUITE_P(Surfaces, DirectLight,
                         testing::Values(Consistency{"coated_gold_area", coated_gold, LightKind::Area, false},
                                         Consistency{"glass_area", glass, LightKind::Area, false},
                                         Consistency{"glass_point_behind", glass, LightKind::Point, true},
                                         Consistency{"coated_glass_area_behind", coated_glass, LightKind::Area, true}),
                         [](const testing::TestParamInfo<Consistency>& test) { return std::string(test.param.name); });

struct Border {
    const char* name;
    RoughSurface surface;
    double lower, upper; ///< ends of the solid in z
};
class PhotonRoughness : public testing::TestWithParam<Border> {};

/// Whether a rough surface takes photons or passes camera paths on must not change the image: a box over a coloured
/// floor under an area light, which it mirrors and, of glass, lets through, seen from above. A
/// box thinner than the search radius must not mix up the photons on its two faces.
TEST_P(PhotonRoughness, DoesNotChangeTheImage) {
    if (std::string(GetParam().name) != "glass" && !long_tests())
        GTEST_SKIP() << "set TRISTIM_LONG_TESTS=1";
    constexpr int width = 4, height = 4, passes = 64;
    Scene scene;
    scene.path = "border";
    scene.camera = look_at({0.0, -2.0, 2.4}, {0, 0, 0.4}, {0, 0, 1}, 5.0);
    add_horizontal_square(
        scene, 2.0, 0.0, true,
        add_diffuse(scene, Spectrum::piecewise_linear({300.0, 500.0, 600.0, 900.0}, {0.05, 0.05, 0.2, 0.2})));
    add_box(scene, {-0.9, -0.9, GetParam().lower}, {0.9, 0.9, GetParam().upper}, false,
            add_rough(scene, GetParam().surface));
    const int light = add_area_light(scene, Spectrum::named("stdillum-D65"), 4.0);
    add_parallelogram(scene, {-0.4, 1.6, 2.4}, {0, 0.8, 0}, {0.8, 0, 0}, add_diffuse(scene, Spectrum::constant(0.2)),
                      light);
    RenderOptions options = small_render("tristimulus:1", width, height, 16384, 0.06, 10);
    options.photon_roughness = 0.0;
    const RenderSet photons = render_seeds(scene, options, passes, 4);
    options.photon_roughness = 1.0;
    const RenderSet paths = render_seeds(scene, options, 2 * passes, 4);
    // Photons blur both: over 0.06 units at distances of one from the floor, and of the box's own lobes: 1e-2.
    expect_same(std::string("border-") + GetParam().name, photons, paths, {1e-2, 0.03});
}

INSTANTIATE_TEST_SUITE_P(Surfaces, PhotonRoughness,
                         testing::Values(Border{"gold", {"", true, true, 0.25, 0.25}, 0.1, 0.3},
                                         Border{"glass", {"", false, true, 0.25, 0.25}, 0.15, 0.55},
                                         Border{"thin_glass", {"", false, true, 0.25, 0.25}, 0.38, 0.4}),
                         [](const testing::TestParamInfo<Border>& test) { return std::string(test.param.name); });

} // namespace
} // namespace tristim::test
