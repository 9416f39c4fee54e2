// Renderers that share a scene on the device, and passes whose wavelengths and paths have seeds of their own.
#include "image_statistics.h"
#include "scene_folder.h"

#include <cstring>

namespace tristim::test {
namespace {

Scene dispersion_scene() {
    return load_scene(TRISTIM_SOURCE_DIR "/meshes/dispersion/scene.pbrt");
}

RenderOptions options_of(const std::string& method) {
    RenderOptions options = small_render(method, 12, 10, 512, 0.1, 8);
    options.radius.reset(); // so that pilots, too, must leave the scene as it is
    options.seed = 3;
    return options;
}

std::shared_ptr<const DeviceScene> put_on_device(const Scene& scene, const RenderOptions& options) {
    return std::make_shared<const DeviceScene>(scene, options, test_device());
}

TEST(RendererSharing, RendersInTurnsAsAlone) {
    const Scene scene = dispersion_scene();
    const std::vector<RenderOptions> options{options_of("tristimulus:2"), options_of("rgb")};
    const auto shared = put_on_device(scene, options[0]);
    std::vector<Renderer> renderers;
    for (const RenderOptions& of_one : options)
        renderers.emplace_back(shared, of_one, test_device());
    for (std::uint32_t pass = 0; pass < 3; ++pass) {
        for (Renderer& renderer : renderers)
            renderer.render_pass(pass);
    }
    for (std::size_t i = 0; i < options.size(); ++i) {
        Renderer alone(scene, options[i], test_device());
        for (std::uint32_t pass = 0; pass < 3; ++pass)
            alone.render_pass(pass);
        EXPECT_EQ(renderers[i].film().xyz, alone.film().xyz) << options[i].method.name();
        EXPECT_EQ(renderers[i].statistics().buffer_bytes, alone.statistics().buffer_bytes)
            << "the memory that a render takes is the same, shared or not";
        EXPECT_EQ(renderers[i].statistics().bvh_seconds, shared->buffers().bvh_seconds());
    }
}

TEST(RendererSharing, EachKeepsItsOwnRays) {
    const Scene scene = dispersion_scene();
    RenderOptions options = options_of("tristimulus:1");
    options.record_rays = true;
    const auto shared = put_on_device(scene, options);
    Renderer many(shared, options, test_device());
    options.photons_per_pass = 64;
    Renderer few(shared, options, test_device());
    many.render_pass(0);
    few.render_pass(0);
    for (const Renderer* renderer : {&many, &few}) {
        const RayTotals traced = renderer->rays();
        EXPECT_EQ(renderer->recorded_rays().size(), traced.camera + traced.shadow + traced.photon);
    }
    EXPECT_GT(many.recorded_rays().size(), few.recorded_rays().size());
}

TEST(RendererSharing, RefusesWhatTheSceneWasNotMadeFor) {
    const Scene scene = dispersion_scene();
    const RenderOptions made_for = options_of("tristimulus:1");
    const auto shared = put_on_device(scene, made_for);
    const auto refusal = [&](const RenderOptions& options, const Device& device) {
        return error_of([&] { Renderer(shared, options, device); });
    };
    RenderOptions options = made_for;
    options.height += 1;
    expect_message(refusal(options, test_device()), "the scene is on the device", "another resolution");
    options = made_for;
    options.region.x = 1;
    options.region.width -= 1;
    expect_message(refusal(options, test_device()), "the scene is on the device", "another region");
    options = made_for;
    options.photon_roughness *= 2.0;
    expect_message(refusal(options, test_device()), "the scene is on the device", "another photon roughness");
    expect_message(refusal(made_for, open_device("")), "the scene is on the device", "another device");
    options = made_for;
    options.max_depth = 0;
    expect_message(refusal(options, test_device()), "maximum depth 0", "not between");
}

TEST(RendererSharing, OneSceneServesAllOptionsThatDoNotTouchIt) {
    const Scene scene = dispersion_scene();
    DeviceScenes scenes(scene);
    const RenderOptions first = options_of("tristimulus:1");
    const auto shared = scenes.get(first, test_device());
    RenderOptions options = options_of("spectral:400");
    options.random_sequence = options.direct_photons = options.statistics_radius = options.fast_math = true;
    options.record_rays = true;
    options.photons_per_pass *= 2;
    options.max_depth += 1;
    options.radius = 0.5;
    options.radius_factor = 2.0;
    options.alpha = 0.5;
    options.seed += 1;
    EXPECT_EQ(scenes.get(options, test_device()), shared);
    options.photon_roughness *= 2.0;
    const auto other = scenes.get(options, test_device());
    EXPECT_NE(other, shared);
    EXPECT_EQ(scenes.get(options, test_device()), other);
    EXPECT_EQ(scenes.get(first, test_device()), shared);
    EXPECT_NE(scenes.get(first, open_device("")), shared);
}

/// What a pass made.
struct PassData {
    std::vector<float> table;
    std::vector<std::array<float, 3>> photons, points;
    explicit PassData(const Renderer& renderer) : table(renderer.pass_table()) {
        for (const Photon& photon : renderer.photons())
            photons.push_back({photon.x, photon.y, photon.z});
        for (const VisiblePoint& point : renderer.visible_points())
            points.push_back({point.x, point.y, point.z});
    }
};

/// Grey surfaces, on which paths go on alike at all wavelengths.
TEST(RendererPassSeeds, WavelengthsAndPathsHaveTheirOwn) {
    Scene scene;
    scene.camera = look_at({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 30.0);
    const int grey = add_diffuse(scene, Spectrum::constant(0.5));
    add_box(scene, {-3, -3, -3}, {3, 3, 3}, true, grey);
    const int lamp = add_area_light(scene, Spectrum::named("stdillum-F12"), 1.0);
    add_parallelogram(scene, {-0.5, -0.5, 2.5}, {0, 1, 0}, {1, 0, 0}, grey, lamp);
    Renderer renderer(scene, options_of("tristimulus:2"), test_device());
    const auto data = [&](const PassSeeds& seeds) {
        renderer.render_pass(seeds);
        return PassData(renderer);
    };
    const PassData first = data({.pass = 4, .seed = 1, .radius_pass = 4, .wavelength_seed = 9});
    ASSERT_FALSE(first.photons.empty());
    const PassData other_paths = data({.pass = 4, .seed = 2, .radius_pass = 4, .wavelength_seed = 9});
    EXPECT_EQ(other_paths.table, first.table);
    EXPECT_NE(other_paths.photons, first.photons);
    EXPECT_NE(other_paths.points, first.points);
    const PassData other_wavelengths = data({.pass = 4, .seed = 1, .radius_pass = 4, .wavelength_seed = 10});
    EXPECT_NE(other_wavelengths.table, first.table);
    EXPECT_EQ(other_wavelengths.photons, first.photons);
    EXPECT_EQ(other_wavelengths.points, first.points);
    const PassData other_pass = data({.pass = 5, .seed = 1, .radius_pass = 4, .wavelength_seed = 9});
    EXPECT_NE(other_pass.table, first.table);
    EXPECT_NE(other_pass.photons, first.photons);
    EXPECT_NE(other_pass.points, first.points);
}

TEST(RendererPassSeeds, OfAPlainPassAreTheRendersSeed) {
    const Scene scene = dispersion_scene();
    const RenderOptions options = options_of("tristimulus:2");
    const auto shared = put_on_device(scene, options);
    Renderer plain(shared, options, test_device());
    plain.render_pass(6);
    Renderer given(shared, options, test_device());
    given.render_pass({.pass = 6, .seed = options.seed, .radius_pass = 6, .wavelength_seed = options.seed});
    EXPECT_EQ(plain.film().xyz, given.film().xyz);
}

} // namespace
} // namespace tristim::test
