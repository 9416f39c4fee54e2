// Whole renders of films at extremes: what is no film renders as none, the most extreme films leave no sample that is
// not finite and reflect no more than there is, and films whose fringes no wavelength bin resolves converge to their
// mean.
#include "image_statistics.h"

#include <cmath>
#include <complex>

namespace tristim::test {
namespace {

FilmLayer layer(double thickness, double eta, double k = 0.0) {
    return {thickness, Spectrum::constant(eta), Spectrum::constant(k)};
}

/// A glass and a metal sphere over a white floor, under a lamp.
Scene spheres(const std::vector<FilmLayer>& on_glass, const std::vector<FilmLayer>& on_metal) {
    Scene scene;
    scene.path = "film stability";
    scene.camera = look_at({0.0, -4.0, 2.0}, {0, 0, 0.5}, {0, 0, 1}, 17.0);
    scene.lights = {environment(Spectrum::named("stdillum-D65"))};
    const int glass = with_film(scene, add_dielectric(scene, Spectrum::constant(1.5)), on_glass);
    const int metal = with_film(
        scene, add_conductor(scene, Spectrum::named("metal-Au-eta"), Spectrum::named("metal-Au-k")), on_metal);
    add_sphere(scene, 0.45, 2, false, glass, {-0.5, 0.0, 0.6});
    add_sphere(scene, 0.45, 2, false, metal, {0.5, 0.0, 0.6});
    add_horizontal_square(scene, 2.0, 0.0, true, add_diffuse(scene, Spectrum::constant(0.8)));
    return scene;
}

RenderOptions options_of(const std::string& method) {
    RenderOptions options = small_render(method, 24, 12, 8192, 0.1, 16);
    options.seed = 5;
    return options;
}

/// The fraction of values that differ by more than rounding, relative to the image's mean.
double share_that_differs(const TestImage& a, const TestImage& b) {
    double mean = 0.0;
    for (const Xyz& xyz : b.xyz)
        mean += xyz[1] / static_cast<double>(b.xyz.size());
    std::size_t different = 0;
    for (std::size_t i = 0; i < a.xyz.size(); ++i) {
        bool differs = false;
        for (std::size_t c = 0; c < 3; ++c)
            differs = differs || !(std::abs(a.xyz[i][c] - b.xyz[i][c]) <= 1e-4 * mean);
        different += differs ? 1 : 0;
    }
    return static_cast<double>(different) / static_cast<double>(a.xyz.size());
}

/// A film of no thickness, one of the index of what lies above it or below it, and no film at all: same paths, same
/// image. A path may choose otherwise where a random number falls between two roundings of a reflectance, with a chance
/// of 1e-6 for each, and then changes its pixel: one in a hundred pixels may.
TEST(FilmStability, FilmsThatAreNoneRenderAsNone) {
    const RenderOptions options = options_of("tristimulus:2");
    const std::vector<FilmLayer> none;
    const TestImage bare = render_image(spheres(none, none), options, 8);
    const auto expect_bare = [&](const char* what, const Scene& scene) {
        EXPECT_LE(share_that_differs(render_image(scene, options, 8), bare), 0.01) << what;
    };
    expect_bare("of no thickness, of the outside's index",
                spheres({layer(0.0, 2.4), layer(0.0, 1.3)}, {layer(1e6, 1.0), layer(0.0, 3.0)}));
    expect_bare("of the glass, too thin to matter", spheres({layer(700.0, 1.5)}, {layer(1e-6, 0.05, 3.0)}));
    // The check can fail: a film of a nanometre is seen.
    EXPECT_GT(share_that_differs(render_image(spheres({layer(5.0, 2.4)}, {layer(5.0, 2.4)}), options, 8), bare), 0.1);
}

int add_textured_film(Scene& scene, int material, double thickest, double k) {
    with_film(scene, material, {layer(0.0, 1.7, k)});
    Texture texture;
    texture.kind = Texture::Kind::Bilinear;
    texture.mapping = Texture::Mapping::Planar;
    texture.world_to_texture = M44d(0.2, 0, 0, 0, 0, 0.2, 0, 0, 0, 0, 1, 0, 0.5, 0.5, 0, 1);
    texture.corners = {0.0, 1e-3, 0.5 * thickest, thickest};
    scene.textures.push_back(texture);
    scene.materials[static_cast<std::size_t>(material)].film.thickness_texture =
        static_cast<int>(scene.textures.size()) - 1;
    return material;
}

/// A row of spheres with the films, seen and lit at every angle, over a floor whose own film grows from nothing to 1
/// mm.
Scene extremes(bool absorbing) {
    Scene scene;
    scene.path = "extreme films";
    scene.camera = look_at({0.0, -6.0, 1.2}, {0, 0, 0.4}, {0, 0, 1}, 24.0);
    scene.lights = {environment(Spectrum::constant(1.0))};
    std::vector<FilmLayer> hundred, thick;
    for (int i = 0; i < 100; ++i) {
        hundred.push_back(layer(i % 2 == 0 ? 58.5 : 94.2, i % 2 == 0 ? 2.35 : 1.46, absorbing ? 1e-4 : 0.0));
        thick.push_back(layer(1e6, i % 2 == 0 ? 1.2 : 1.8));
    }
    const double k = absorbing ? 10.0 : 0.0;
    const auto glass = [&](double eta) { return add_dielectric(scene, Spectrum::constant(eta)); };
    const auto metal = [&](double eta, double its_k) {
        return add_conductor(scene, Spectrum::constant(eta), Spectrum::constant(its_k));
    };
    const std::vector<int> materials{
        with_film(scene, glass(1.5), {layer(1e-3, 2.4, k)}),
        with_film(scene, glass(1.5), {layer(1e6, 1.5)}),
        with_film(scene, glass(1.0), {layer(300.0, 1.0)}),
        with_film(scene, glass(2.5), hundred),
        with_film(scene, glass(1.9), thick),
        with_film(scene, metal(0.05, 1000.0), {layer(400.0, 1.46)}),
        with_film(scene, metal(1.0, 0.0), {layer(1e6, 4.0, 0.1 * k)}),
        with_film(scene, metal(100.0, 100.0), {layer(50.0, 0.05, k), layer(1e6, 1.3)}),
    };
    for (std::size_t i = 0; i < materials.size(); ++i)
        add_sphere(scene, 0.24, 2, false, materials[i], {0.5 * static_cast<double>(i) - 1.75, 0.0, 0.4});
    const int floor = add_diffuse(scene, Spectrum::constant(0.9));
    add_horizontal_square(scene, 2.5, 0.0, true, add_textured_film(scene, floor, 1e6, absorbing ? 1e-5 : 0.0));
    return scene;
}

/// Radiance 1 from everywhere: no pixel can be brighter, and where nothing absorbs but floor and metal, none is black.
TEST(FilmStability, ExtremeFilmsLeaveNoSampleOut) {
    for (const bool absorbing : {false, true}) {
        RenderOptions options = options_of("tristimulus:4");
        options.direct_photons = absorbing;
        const TestImage image = render_image(extremes(absorbing), options, 8); // expects no rejected sample
        double mean = 0.0;
        for (const Xyz& xyz : image.xyz) {
            ASSERT_TRUE(std::isfinite(xyz[0] + xyz[1] + xyz[2]));
            mean += xyz[1] / static_cast<double>(image.xyz.size());
        }
        EXPECT_GT(mean, 0.5) << absorbing;
        EXPECT_LT(mean, 1.01) << absorbing; // photons' noise in the mean: some 0.003
    }
}

/// Power reflected of light that meets an interface between indices a and b, polarised across the plane of incidence or
/// in it (Born & Wolf 1999, 1.5.2 and 14.2); q are √(ε - β²).
double interface_power(std::complex<double> a, std::complex<double> b, double beta2, bool p_polarised) {
    const std::complex<double> qa = std::sqrt(a * a - beta2), qb = std::sqrt(b * b - beta2);
    return p_polarised ? std::norm((b * b * qa - a * a * qb) / (b * b * qa + a * a * qb))
                       : std::norm((qa - qb) / (qa + qb));
}

/// The mean over a whole fringe of what a clear layer of index n on a base reflects: of Airy's |r1 + r2 e^{iφ}|²/|1 +
/// r1 r2 e^{iφ}|² over φ, (R1 + R2 - 2 R1 R2)/(1 - R1 R2).
double mean_over_fringes(double n, std::complex<double> base, double cosine) {
    const double beta2 = (1.0 - cosine) * (1.0 + cosine);
    double sum = 0.0;
    for (const bool p_polarised : {false, true}) {
        const double upper = interface_power(1.0, n, beta2, p_polarised),
                     lower = interface_power(n, base, beta2, p_polarised);
        sum += 0.5 * (upper + lower - 2.0 * upper * lower) / (1.0 - upper * lower);
    }
    return sum;
}

/// A millimetre has a fringe every 0.1 nm; the wavelengths of a pass lie 10 nm and more apart. Their mean over the
/// passes is the mean over the fringes all the same, with random and with stratified wavelengths.
TEST(FilmStability, ThickFilmsConvergeToTheirMean) {
    constexpr int width = 2, height = 3;
    constexpr double n = 1.46;
    const std::complex<double> base(1.2, 2.0);
    Scene scene;
    scene.path = "thick film";
    scene.camera = look_at({0, -3, 1.6}, {0, 0, 0}, {0, 0, 1}, 12.0);
    scene.lights = {environment(Spectrum::named("stdillum-A"))};
    const int metal = add_conductor(scene, Spectrum::constant(base.real()), Spectrum::constant(base.imag()));
    add_horizontal_square(scene, 100.0, 0.0, true, with_film(scene, metal, {layer(1e6, n)}));
    TestImage exact{width, height, {}};
    for (int pixel = 0; pixel < width * height; ++pixel) {
        const double mean =
            pixel_mean(scene.camera, width, height, pixel % width, pixel / width,
                       [&](const CameraRay& ray) { return mean_over_fringes(n, base, -ray.direction.z); });
        exact.xyz.push_back(integrate_xyz(scene.lights.front().emission, [&](double) { return mean; }));
    }
    for (const bool random : {false, true}) {
        RenderOptions options = small_render("tristimulus:8", width, height, 64, 0.1, 4);
        options.random_sequence = random;
        expect_exact(random ? "thick film, random wavelengths" : "thick film, stratified wavelengths",
                     render_seeds(scene, options, 128, 6), exact, {1e-3, 0.01});
    }
}

} // namespace
} // namespace tristim::test
