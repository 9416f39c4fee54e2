// Thin films in whole scenes: furnaces, closed forms, and spectral rendering against tristimulus rendering.
#include "image_statistics.h"
#include "method_cases.h"
#include "microfacet_oracle.h"
#include "selftest/film_oracle.h"

#include <cmath>
#include <map>

namespace tristim::test {
namespace {

TestImage uniform_image(int width, int height, const Xyz& xyz) {
    return {width, height, std::vector<Xyz>(static_cast<std::size_t>(width * height), xyz)};
}

FilmLayer layer(double thickness, double eta_at_300, double eta_at_900) {
    return {thickness, Spectrum::piecewise_linear({300.0, 900.0}, {eta_at_300, eta_at_900}), Spectrum::constant(0.0)};
}

/// Spheres that absorb nothing: one layer, a stack on `glass`, and a bubble.
void add_lossless_spheres(Scene& scene, const Spectrum& glass) {
    const int coated = with_film(scene, add_dielectric(scene, Spectrum::constant(1.5)), {layer(320.0, 1.48, 1.45)});
    const int stack = with_film(scene, add_dielectric(scene, glass),
                                {layer(94.0, 1.47, 1.45), layer(55.0, 2.9, 2.4), layer(94.0, 1.47, 1.45)});
    const int bubble = with_film(scene, add_dielectric(scene, Spectrum::constant(1.0)), {layer(420.0, 1.35, 1.33)});
    add_sphere(scene, 0.4, 2, false, coated, {-0.9, 0.0, 0.7});
    add_sphere(scene, 0.4, 2, false, stack, {0.0, 0.0, 0.7});
    add_sphere(scene, 0.4, 2, false, bubble, {0.9, 0.0, 0.7});
}

/// White under a film whose thickness varies from 100 to 600 nm over the floor.
int add_white_under_wedge(Scene& scene) {
    const int white = with_film(scene, add_diffuse(scene, Spectrum::constant(1.0)), {layer(0.0, 1.9, 1.6)});
    Texture texture;
    texture.kind = Texture::Kind::Bilinear;
    texture.mapping = Texture::Mapping::Planar;
    texture.world_to_texture = M44d(0.25, 0, 0, 0, 0, 0.25, 0, 0, 0, 0, 1, 0, 0.5, 0.5, 0, 1);
    texture.corners = {100.0, 300.0, 400.0, 600.0};
    scene.textures.push_back(texture);
    scene.materials[static_cast<std::size_t>(white)].film.thickness_texture =
        static_cast<int>(scene.textures.size()) - 1;
    return white;
}

class FilmFurnace : public testing::TestWithParam<MethodCase> {};

/// Radiance 1 from everywhere, and nothing that absorbs: 1 in every pixel. What misses: paths cut after 64 vertices,
/// and the error of internal_reflectance.h, 2e-7.
TEST_P(FilmFurnace, NothingIsSeen) {
    constexpr int width = 12, height = 6;
    const Spectrum emission = Spectrum::constant(1.0);
    Scene scene;
    scene.path = "film furnace";
    scene.camera = look_at({0.0, -4.0, 2.0}, {0, 0, 0.5}, {0, 0, 1}, 17.0);
    scene.lights = {environment(emission)};
    add_lossless_spheres(scene, Spectrum::named("glass-F11"));
    add_horizontal_square(scene, 2.0, 0.0, true, add_white_under_wedge(scene));
    RenderOptions options = small_render(GetParam().method, width, height, 8192, 0.1, 64);
    options.direct_photons = GetParam().direct_photons;
    expect_exact("film-furnace-" + method_case_name({GetParam(), 0}), render_seeds(scene, options, 24, 4),
                 uniform_image(width, height, integrate_xyz(emission, [](double) { return 1.0; })), {1e-4, 0.02});
}

/// The same within walls that emit half and reflect half.
TEST_P(FilmFurnace, NothingIsSeenWithinEmittingWalls) {
    constexpr int width = 8, height = 6;
    const Spectrum white = Spectrum::named("stdillum-D65");
    Scene scene;
    scene.path = "film furnace";
    scene.camera = look_at({0.2, -1.6, 1.5}, {0, 0, 0.5}, {0, 0, 1}, 20.0);
    const int walls = add_diffuse(scene, Spectrum::constant(0.5));
    add_box(scene, {-2, -2, -0.4}, {2, 2, 2}, true, walls, add_area_light(scene, white, 0.5));
    add_lossless_spheres(scene, Spectrum::named("glass-F11"));
    add_horizontal_square(scene, 1.2, 0.0, true, add_white_under_wedge(scene));
    RenderOptions options = small_render(GetParam().method, width, height, 16384, 0.15, 64);
    options.direct_photons = GetParam().direct_photons;
    expect_exact("film-walls-" + method_case_name({GetParam(), 0}), render_seeds(scene, options, 24, 4),
                 uniform_image(width, height, integrate_xyz(white, [](double) { return 1.0; })), {1e-4, 0.03});
}

/// Of one wavelength out of 400 that glass keeps where it disperses little is seen: this glass does not, and the film
/// on the floor is the same everywhere.
TEST(SpectralFilmFurnace, NothingIsSeen) {
    constexpr int width = 6, height = 4;
    const Spectrum emission = Spectrum::constant(1.0);
    Scene scene;
    scene.path = "film furnace";
    scene.camera = look_at({0.0, -4.0, 2.0}, {0, 0, 0.5}, {0, 0, 1}, 17.0);
    scene.lights = {environment(emission)};
    add_lossless_spheres(scene, Spectrum::constant(1.7));
    add_horizontal_square(scene, 2.0, 0.0, true,
                          with_film(scene, add_diffuse(scene, Spectrum::constant(1.0)), {layer(380.0, 1.9, 1.6)}));
    expect_exact("film-furnace-spectral",
                 render_seeds(scene, small_render("spectral:400", width, height, 2048, 0.15, 64), 12, 4),
                 uniform_image(width, height, integrate_xyz(emission, [](double) { return 1.0; })), {1e-4, 0.03});
}

INSTANTIATE_TEST_SUITE_P(Methods, FilmFurnace,
                         testing::Values(MethodCase{"tristimulus:2", false}, MethodCase{"tristimulus:2", true}),
                         method_case_name);

std::vector<oracle::Layer> oracle_layers(const Film& film, double lambda) {
    std::vector<oracle::Layer> layers;
    for (const FilmLayer& l : film.layers)
        layers.push_back({l.thickness, l.eta(lambda), l.k(lambda)});
    return layers;
}

/// A camera that looks at the plane z = 0 under a uniform environment from steep to grazing angles: `albedo` is the
/// plane's.
void expect_albedo(const std::string& name, const Scene& scene, const std::function<double(double, double)>& albedo) {
    constexpr int width = 2, height = 4;
    const Spectrum light = scene.lights.front().emission;
    TestImage exact{width, height, {}};
    for (int pixel = 0; pixel < width * height; ++pixel) {
        // Films are tabulated every 4 nm, pixels by 8 rows: the cosine hardly changes along a row.
        std::array<double, 101> values{};
        for (std::size_t i = 0; i < values.size(); ++i) {
            for (int row = 0; row < 8; ++row) {
                const CameraRay ray =
                    camera_ray(scene.camera, width, height, pixel % width + 0.5, pixel / width + (row + 0.5) / 8);
                values[i] += albedo(380.0 + 4.0 * static_cast<double>(i), -ray.direction.z) / 8.0;
            }
        }
        exact.xyz.push_back(integrate_xyz(light, [&](double lambda) {
            const double x = (lambda - 380.0) / 4.0;
            const auto i = std::min<std::size_t>(static_cast<std::size_t>(x), 99);
            return values[i] + (x - static_cast<double>(i)) * (values[i + 1] - values[i]);
        }));
    }
    // Lines over 4 nm of fringes a hundred nm wide, and the kernels' data at bin means joined by lines: 1e-3.
    expect_exact(name, render_seeds(scene, small_render("tristimulus:20", width, height, 64, 0.1, 4), 64, 4), exact,
                 {1e-3, 0.01});
}

Scene open_plane(int (*add_material)(Scene&)) {
    Scene scene;
    scene.path = "plane";
    scene.camera = look_at({0, -3, 1.6}, {0, 0, 0}, {0, 0, 1}, 12.0);
    scene.lights = {environment(Spectrum::named("stdillum-A"))};
    const int material = add_material(scene);
    add_horizontal_square(scene, 100.0, 0.0, true, material);
    return scene;
}

TEST(FilmMirror, ReflectsTheEnvironmentByTheOracle) {
    const Scene scene = open_plane([](Scene& s) {
        return with_film(s, add_conductor(s, Spectrum::named("metal-Al-eta"), Spectrum::named("metal-Al-k")),
                         {layer(350.0, 1.48, 1.45), layer(60.0, 2.9, 2.4)});
    });
    const Material& m = scene.materials.front();
    expect_albedo("film-mirror", scene, [&](double lambda, double cosine) {
        const oracle::FilmOptics o =
            oracle::film(1.0, oracle_layers(m.film, lambda), m.eta(lambda), m.k(lambda), lambda, cosine, true);
        return 0.5 * (o.reflected_s + o.reflected_p);
    });
}

/// R + T ρ/(n² (1 - ρF)) ∫T 2μ dμ, F the film's reflectance for diffuse light from below.
TEST(CoatedDiffuse, HasTheClosedFormsAlbedo) {
    const Scene scene = open_plane([](Scene& s) {
        const int body =
            with_film(s, add_diffuse(s, Spectrum::piecewise_linear({300.0, 500.0, 600.0, 900.0}, {0.2, 0.3, 0.9, 0.9})),
                      {layer(280.0, 2.4, 2.1)});
        s.materials.back().film.layers.front().k = Spectrum::constant(0.02);
        return body;
    });
    const Material& m = scene.materials.front();
    const auto rule = kernel_test::gauss_legendre(16);
    struct Diffuse {
        double in = 0.0, out = 0.0; ///< F and ∫T 2μ dμ
    };
    std::map<double, Diffuse> tables;
    const auto film = [&](double lambda, double cosine, bool outside) {
        const oracle::FilmOptics o =
            oracle::film(1.0, oracle_layers(m.film, lambda), m.eta(lambda), 0.0, lambda, cosine, outside);
        return std::array{0.5 * (o.reflected_s + o.reflected_p), 0.5 * (o.transmitted_s + o.transmitted_p)};
    };
    expect_albedo("coated-diffuse", scene, [&](double lambda, double cosine) {
        const double n = m.eta(lambda), rho = m.reflectance(lambda);
        if (tables.count(lambda) == 0) {
            Diffuse d;
            const double critical = std::sqrt(1.0 - 1.0 / (n * n));
            for (const auto& node : rule) {
                // Substituted by squares from the critical angle on both sides, where slopes are infinite.
                const double below = critical * (1.0 - node.x * node.x),
                             above = critical + (1.0 - critical) * node.x * node.x;
                d.in += node.weight * 2.0 * node.x *
                        (critical * film(lambda, below, false)[0] * 2.0 * below +
                         (1.0 - critical) * film(lambda, above, false)[0] * 2.0 * above);
                d.out += node.weight * film(lambda, node.x, true)[1] * 2.0 * node.x;
            }
            tables[lambda] = d;
        }
        const Diffuse& d = tables[lambda];
        const auto [r, t] = film(lambda, cosine, true);
        return r + t * rho / (n * n * (1.0 - rho * d.in)) * d.out;
    });
}

/// Everything that a film may lie on, in one room: both methods show the same.
TEST(FilmScene, SpectralAndTristimulusRenderingAgree) {
    constexpr int width = 12, height = 6;
    Scene scene;
    scene.path = "films";
    scene.camera = look_at({0.0, -4.0, 2.0}, {0, 0, 0.5}, {0, 0, 1}, 17.0);
    const int glass = with_film(scene, add_dielectric(scene, Spectrum::named("glass-F11")), {layer(420.0, 1.35, 1.33)});
    const int metal =
        with_film(scene, add_conductor(scene, Spectrum::named("metal-Ag-eta"), Spectrum::named("metal-Ag-k")),
                  {layer(300.0, 2.9, 2.4)});
    const int rough =
        with_film(scene, add_conductor(scene, Spectrum::named("metal-Au-eta"), Spectrum::named("metal-Au-k")),
                  {layer(200.0, 1.48, 1.45)});
    scene.materials.back().alpha_u = scene.materials.back().alpha_v = 0.3;
    const int floor = with_film(
        scene, add_diffuse(scene, Spectrum::piecewise_linear({300.0, 500.0, 600.0, 900.0}, {0.2, 0.3, 0.9, 0.9})),
        {layer(250.0, 1.9, 1.8)});
    add_sphere(scene, 0.4, 2, false, glass, {-0.9, 0.0, 0.7});
    add_sphere(scene, 0.4, 2, false, metal, {0.0, 0.0, 0.7});
    add_sphere(scene, 0.4, 2, false, rough, {0.9, 0.0, 0.7});
    add_horizontal_square(scene, 2.0, 0.0, true, floor);
    const int light = add_area_light(scene, Spectrum::named("stdillum-F11"), 4.0);
    add_parallelogram(scene, {-0.8, -0.8, 3.0}, {0, 1.6, 0}, {1.6, 0, 0}, add_diffuse(scene, Spectrum::constant(0.0)),
                      light);
    const RenderSet spectral = render_seeds(scene, small_render("spectral:400", width, height, 4096, 0.15, 10), 16, 4);
    const RenderSet tristimulus =
        render_seeds(scene, small_render("tristimulus:4", width, height, 4096, 0.15, 10), 64, 4, 100);
    // The radius' schedule differs with the number of passes, by r² of the floor's lighting over 3 units: 1e-2.
    expect_same("film-scene", spectral, tristimulus, {1e-2, 0.05});
}

} // namespace
} // namespace tristim::test
