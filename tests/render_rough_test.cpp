// Rough conductors and dielectrics, with and without films: camera and photon paths against each other and against
// quadratures.
#include "image_statistics.h"

#include "microfacet_oracle.h"
#include "thin_film_oracle.h"

#include <cmath>
#include <numbers>

namespace tristim::test {
namespace {

using kernel_test::Ggx;
using kernel_test::Vec3;
using kernel_test::operator*;
using kernel_test::operator-;
using kernel_test::operator+;

struct RoughSurface {
    const char* name;
    bool conductor;
    bool film;
    double alpha_u, alpha_v;
};

int add_rough(Scene& scene, const RoughSurface& surface) {
    const int material =
        surface.conductor ? add_conductor(scene, Spectrum::named("metal-Au-eta"), Spectrum::named("metal-Au-k"))
                          : add_dielectric(scene, Spectrum::constant(1.5));
    Material& m = scene.materials[static_cast<std::size_t>(material)];
    m.alpha_u = surface.alpha_u;
    m.alpha_v = surface.alpha_v;
    if (surface.film)
        m.film.layers = {{300.0, Spectrum::constant(2.2), Spectrum::constant(0.02)}};
    return material;
}

Light point_light(const V3d& position, double intensity) {
    Light light;
    light.kind = Light::Kind::Point;
    light.emission = Spectrum::named("stdillum-D65");
    light.position = position;
    light.scale = intensity;
    return light;
}

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
    constexpr int width = 4, height = 4;
    Scene scene;
    scene.path = "rough";
    scene.camera = look_at({0.3, -1.6, 1.5}, {0, 0, 0}, {0, 0, 1}, 14.0);
    add_horizontal_square(scene, 1.2, 0.0, true, add_rough(scene, GetParam().surface));
    light_from(scene, GetParam().light, GetParam().behind ? V3d(-0.1, 0.6, -1.2) : V3d(-0.1, 1.0, 1.2));
    RenderOptions options = small_render("tristimulus:1", width, height, 16384, 0.05, 6);
    const RenderSet sampled = render_seeds(scene, options, 64, 6);
    options.direct_photons = true;
    const RenderSet photons = render_seeds(scene, options, 32, 6);
    // The mean over a disc of radius 0.05 at distances about 1.4 from light and camera, of a lobe some α wide: 6e-3.
    expect_same(GetParam().name, photons, sampled, {6e-3, 0.02});
}

constexpr RoughSurface gold{"gold", true, false, 0.3, 0.3}, coated_gold{"coated_gold", true, true, 0.25, 0.5},
    glass{"glass", false, false, 0.3, 0.3}, coated_glass{"coated_glass", false, true, 0.5, 0.25};
INSTANTIATE_TEST_SUITE_P(
    Surfaces, DirectLight,
    testing::Values(Consistency{"gold_point", gold, LightKind::Point, false},
                    Consistency{"coated_gold_area", coated_gold, LightKind::Area, false},
                    Consistency{"glass_area", glass, LightKind::Area, false},
                    Consistency{"glass_point_behind", glass, LightKind::Point, true},
                    Consistency{"coated_glass_area_behind", coated_glass, LightKind::Area, true},
                    Consistency{"coated_glass_point", coated_glass, LightKind::Point, false}),
    [](const testing::TestParamInfo<Consistency>& test) { return std::string(test.param.name); });

/// Radiance along `ray` from the sheet z = 0 with normal +z, whose u and v run along x and y, that light from `incident` with
/// irradiance times cosine `e` causes, at a wavelength. For light that comes through the sheet, radiance below is 1/η² of what it
/// would be: light in the medium that the sheet stands for.
double brdf(const RoughSurface& surface, const Material& m, const V3d& to_camera, const V3d& to_light, double lambda) {
    const Ggx ggx(cl_float2{{static_cast<float>(surface.alpha_u), static_cast<float>(surface.alpha_v)}});
    const Vec3 wo{to_camera.x, to_camera.y, to_camera.z}, wi{to_light.x, to_light.y, to_light.z};
    std::vector<oracle::Layer> layers;
    for (const FilmLayer& layer : m.film.layers)
        layers.push_back({layer.thickness, layer.eta(lambda), layer.k(lambda)});
    const double eta = m.eta(lambda), k = surface.conductor ? m.k(lambda) : 0.0;
    if (wi[2] > 0.0) {
        const double cosine = kernel_test::dot(wo, Ggx::reflecting(wo, wi));
        const oracle::FilmOptics o = oracle::film(1.0, layers, eta, k, lambda, cosine, true);
        return ggx.reflection(wo, wi) * 0.5 * (o.reflected_s + o.reflected_p);
    }
    const Vec3 h = Ggx::refracting(wo, wi, eta);
    if (surface.conductor || !Ggx::refracts(wo, wi, h))
        return 0.0;
    const oracle::FilmOptics o = oracle::film(1.0, layers, eta, 0.0, lambda, kernel_test::dot(wo, h), true);
    return ggx.refraction(wo, wi, eta) / (eta * eta) * 0.5 * (o.transmitted_s + o.transmitted_p);
}

/// The BSDF of a surface with a film varies slowly with the wavelength: its values every 10 nm, joined by lines.
struct Tabulated {
    std::array<double, 41> value{};
    double operator()(double lambda) const {
        const double x = (lambda - 380.0) / 10.0;
        const auto i = std::min<std::size_t>(static_cast<std::size_t>(x), 39);
        return value[i] + (x - static_cast<double>(i)) * (value[i + 1] - value[i]);
    }
};
template <typename Function>
Tabulated tabulate(Function&& f) {
    Tabulated t;
    for (std::size_t i = 0; i < t.value.size(); ++i)
        t.value[i] = f(380.0 + 10.0 * static_cast<double>(i));
    return t;
}

struct Highlight {
    const char* name;
    RoughSurface surface;
    bool behind;
};
class PointHighlight : public testing::TestWithParam<Highlight> {};

/// A point light's highlight is BRDF · I cos θ / d²: by light sampling, rough enough for photons or not.
TEST_P(PointHighlight, IsTheBrdfItself) {
    constexpr int width = 6, height = 3;
    const RoughSurface& surface = GetParam().surface;
    Scene scene;
    scene.path = "highlight";
    scene.camera = look_at({0.3, -1.6, 1.5}, {0, 0, 0}, {0, 0, 1}, 10.0);
    const int material = add_rough(scene, surface);
    add_horizontal_square(scene, 2.0, 0.0, true, material);
    const V3d at = GetParam().behind ? V3d(-0.25, 0.7, -1.6) : V3d(-0.3, 1.6, 1.5);
    scene.lights = {point_light(at, 3.0)};
    const Material& m = scene.materials[static_cast<std::size_t>(material)];
    TestImage exact{width, height, {}};
    for (int pixel = 0; pixel < width * height; ++pixel) {
        const Tabulated value = tabulate([&](double lambda) {
            return pixel_mean(scene.camera, width, height, pixel % width, pixel / width, [&](const CameraRay& ray) {
                const V3d p = at_height(ray, 0.0);
                const V3d towards = at - p;
                const double d2 = towards.length2();
                return brdf(surface, m, -ray.direction, towards.normalized(), lambda) * 3.0 *
                       std::abs(towards.z) / (d2 * std::sqrt(d2));
            });
        });
        exact.xyz.push_back(integrate_xyz(Spectrum::named("stdillum-D65"), value));
    }
    const RenderOptions options = small_render("tristimulus:4", width, height, 64, 0.01, 2);
    // 8×8 midpoints over pixels of 0.1 on lobes 0.05 wide, and lines over 10 nm of fringes hundreds of nm wide: 3e-3.
    expect_exact(std::string("highlight-") + GetParam().name, render_seeds(scene, options, 96, 6), exact, {3e-3, 0.02});
}

constexpr RoughSurface polished_gold{"gold", true, false, 0.05, 0.05}, polished_coated{"coated", true, true, 0.04, 0.08},
    polished_glass{"glass", false, true, 0.05, 0.05};
INSTANTIATE_TEST_SUITE_P(Surfaces, PointHighlight,
                         testing::Values(Highlight{"gold", polished_gold, false}, Highlight{"coated_gold", polished_coated, false},
                                         Highlight{"rough_coated_gold", coated_gold, false},
                                         Highlight{"glass", polished_glass, false}, Highlight{"glass_behind", polished_glass, true},
                                         Highlight{"rough_glass_behind", coated_glass, true}),
                         [](const testing::TestParamInfo<Highlight>& test) { return std::string(test.param.name); });

struct Mirrored {
    const char* name;
    double alpha_u, alpha_v;
    bool conductor, behind, infinite;
};
class SeenLight : public testing::TestWithParam<Mirrored> {};

/// An area light, or a uniform environment, reflected in a nearly specular surface (or seen through it), by light sampling and by
/// chance together: ∫ f cos over the light, and the albedo.
TEST_P(SeenLight, IsTheQuadrature) {
    constexpr int width = 3, height = 3;
    const RoughSurface surface{"", GetParam().conductor, true, GetParam().alpha_u, GetParam().alpha_v};
    Scene scene;
    scene.path = "seen";
    scene.camera = look_at({0.3, -1.6, 1.5}, {0, 0, 0}, {0, 0, 1}, 10.0);
    const int material = add_rough(scene, surface);
    add_horizontal_square(scene, 30.0, 0.0, true, material);
    const double z = GetParam().behind ? -1.6 : 1.5;
    const V3d corner(-0.8, GetParam().behind ? 0.1 : 1.2, z);
    const V3d edge_x(0.7, 0, 0), edge_y(0, 0.7, 0);
    if (GetParam().infinite) {
        Light light;
        light.kind = Light::Kind::Infinite;
        light.emission = Spectrum::named("stdillum-D65");
        light.scale = 1.0;
        scene.lights = {light};
    } else {
        const int light = add_area_light(scene, Spectrum::named("stdillum-D65"), 5.0);
        const int black = add_diffuse(scene, Spectrum::constant(0.0));
        if (GetParam().behind)
            add_parallelogram(scene, corner, edge_x, edge_y, black, light);
        else
            add_parallelogram(scene, corner, edge_y, edge_x, black, light);
    }
    const Material& m = scene.materials[static_cast<std::size_t>(material)];
    const auto rule = kernel_test::gauss_legendre(12);
    // Over facets: the lobe is smooth there. Over the light: pieces small against the lobe.
    constexpr int pieces = 24;
    TestImage exact{width, height, {}};
    for (int pixel = 0; pixel < width * height; ++pixel) {
        std::array<double, 41> mean{};
        constexpr int points = 3;
        for (int sub = 0; sub < points * points; ++sub) {
            const CameraRay ray = camera_ray(scene.camera, width, height, pixel % width + (sub % points + 0.5) / points,
                                             pixel / width + (sub / points + 0.5) / points);
            const V3d p = at_height(ray, 0.0);
            const V3d wo = -ray.direction;
            const Ggx ggx(cl_float2{{static_cast<float>(surface.alpha_u), static_cast<float>(surface.alpha_v)}});
            // geometry and the facet's cosine first: the shares of power depend on the cosine alone
            std::vector<std::array<double, 3>> lobes; // weight, cosine, whether reflected
            const Vec3 o{wo.x, wo.y, wo.z};
            if (GetParam().infinite) {
                const kernel_test::Lune lune(o, {{static_cast<float>(surface.alpha_u), static_cast<float>(surface.alpha_v)}});
                for (int i = 0; i < 3 * pieces; ++i) {
                    for (int j = 0; j < 3 * pieces; ++j) {
                        const auto [h, solid] = lune.facet((i + 0.5) / (3 * pieces), (j + 0.5) / (3 * pieces));
                        const double share = ggx.visible_pdf(o, h) * solid / (9.0 * pieces * pieces);
                        const double c = kernel_test::dot(o, h);
                        const Vec3 mirrored = 2.0 * c * h - o;
                        if (mirrored[2] > 0.0)
                            lobes.push_back({share * ggx.masking_shadowing(o, mirrored) / ggx.masking(o), c, 1.0});
                        if (surface.conductor)
                            continue;
                        const double inverse = 1.0 / 1.5, cos_t = std::sqrt(1.0 - (1.0 - c * c) * inverse * inverse);
                        const Vec3 through = -inverse * o + (inverse * c - cos_t) * h;
                        if (through[2] < 0.0)
                            lobes.push_back(
                                {share * ggx.masking_shadowing(o, through) / ggx.masking(o) * inverse * inverse, c, 0.0});
                    }
                }
            } else {
                for (int i = 0; i < pieces; ++i) {
                    for (int j = 0; j < pieces; ++j) {
                        const V3d q = corner + (i + 0.5) / pieces * edge_x + (j + 0.5) / pieces * edge_y;
                        const V3d towards = q - p;
                        const double d2 = towards.length2();
                        const V3d wi = towards / std::sqrt(d2);
                        const double solid = 0.49 / (pieces * pieces) * std::abs(wi.z) / d2;
                        const Vec3 in{wi.x, wi.y, wi.z};
                        if (wi.z > 0.0) {
                            lobes.push_back({5.0 * ggx.reflection(o, in) * std::abs(wi.z) * solid,
                                             kernel_test::dot(o, Ggx::reflecting(o, in)), 1.0});
                        } else {
                            const Vec3 h = Ggx::refracting(o, in, 1.5);
                            if (Ggx::refracts(o, in, h))
                                lobes.push_back({5.0 * ggx.refraction(o, in, 1.5) / 2.25 * std::abs(wi.z) * solid,
                                                 kernel_test::dot(o, h), 0.0});
                        }
                    }
                }
            }
            // Shares as lines between 60 cosines around the lobe's.
            double low = 1.0, high = 0.0;
            for (const auto& lobe : lobes) {
                low = std::min(low, lobe[1]);
                high = std::max(high, lobe[1]);
            }
            constexpr int steps = 60;
            std::array<std::array<double, 2>, steps + 2> sums{}; // weights of the nodes
            for (const auto& lobe : lobes) {
                const double x = high > low ? (lobe[1] - low) / (high - low) * steps : 0.0;
                const int i = std::min(static_cast<int>(x), steps - 1);
                const auto which = static_cast<std::size_t>(lobe[2]);
                sums[static_cast<std::size_t>(i)][which] += lobe[0] * (i + 1 - x);
                sums[static_cast<std::size_t>(i) + 1][which] += lobe[0] * (x - i);
            }
            for (std::size_t w = 0; w < mean.size(); ++w) {
                const double lambda = 380.0 + 10.0 * static_cast<double>(w);
                const double eta = m.eta(lambda), k = surface.conductor ? m.k(lambda) : 0.0;
                for (std::size_t i = 0; i <= steps; ++i) {
                    const oracle::FilmOptics f =
                        oracle::film(1.0, {{300.0, 2.2, 0.02}}, eta, k, lambda,
                                     std::min(1.0, low + (high - low) * static_cast<double>(i) / steps), true);
                    mean[w] += (0.5 * (f.reflected_s + f.reflected_p) * sums[i][1] +
                                0.5 * (f.transmitted_s + f.transmitted_p) * sums[i][0]) /
                               (points * points);
                }
            }
        }
        Tabulated t;
        t.value = mean;
        exact.xyz.push_back(integrate_xyz(Spectrum::named("stdillum-D65"), t));
    }
    const RenderOptions options = small_render("tristimulus:4", width, height, 64, 0.01, 2);
    // 3×3 midpoints of a pixel and lines over 10 nm: 4e-3.
    expect_exact(std::string("seen-") + GetParam().name, render_seeds(scene, options, 256, 6), exact, {4e-3, 0.02});
}

INSTANTIATE_TEST_SUITE_P(Surfaces, SeenLight,
                         testing::Values(Mirrored{"gold", 0.06, 0.06, true, false, false},
                                         Mirrored{"brushed_gold", 0.09, 0.04, true, false, false},
                                         Mirrored{"rough_gold", 0.3, 0.2, true, false, false},
                                         Mirrored{"glass", 0.06, 0.06, false, false, false},
                                         Mirrored{"glass_behind", 0.06, 0.06, false, true, false},
                                         Mirrored{"rough_glass_behind", 0.3, 0.3, false, true, false},
                                         Mirrored{"gold_in_the_open", 0.06, 0.09, true, false, true},
                                         Mirrored{"glass_in_the_open", 0.06, 0.06, false, false, true},
                                         Mirrored{"rough_glass_in_the_open", 0.3, 0.3, false, false, true},
                                         Mirrored{"rough_gold_in_the_open", 0.5, 0.2, true, false, true}),
                         [](const testing::TestParamInfo<Mirrored>& test) { return std::string(test.param.name); });

} // namespace
} // namespace tristim::test
