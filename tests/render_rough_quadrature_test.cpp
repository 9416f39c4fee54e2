// Rough conductors and dielectrics with films, against quadratures of their BSDFs.

#include "image_statistics.h"
#include "microfacet_oracle.h"
#include "rough_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

namespace tristim::test {
namespace {

using kernel_test::Ggx;
using kernel_test::Vec3;
using kernel_test::operator*;
using kernel_test::operator-;
using kernel_test::operator+;

/// Shares of power that an interface reflects and transmits, of unpolarised light from outside: Fresnel's equations
/// and, with one layer, Airy's sum (Born & Wolf 1999, section 7.6.1) for complex indices.
struct Shares {
    double reflected, transmitted;
};
Shares interface_shares(const RoughSurface& surface, const Material& m, double lambda, double cosine) {
    using Complex = std::complex<double>;
    const Complex base(m.eta(lambda), surface.conductor ? m.k(lambda) : 0.0);
    std::array<Complex, 3> n{1.0, base, base};
    Complex phase = 0.0;
    if (surface.film) {
        const FilmLayer& layer = m.film.layers.front();
        n[1] = {layer.eta(lambda), layer.k(lambda)};
        phase = 2.0 * std::numbers::pi * layer.thickness / lambda;
    }
    std::array<Complex, 3> q;
    for (std::size_t i = 0; i < 3; ++i)
        q[i] = std::sqrt(n[i] * n[i] - (1.0 - cosine * cosine));
    const Complex once = std::exp(Complex(0.0, 1.0) * phase * q[1]);
    Shares shares{};
    for (const bool p : {false, true}) {
        std::array<Complex, 3> y;
        for (std::size_t i = 0; i < 3; ++i)
            y[i] = p ? n[i] * n[i] / q[i] : q[i];
        const Complex r01 = (y[0] - y[1]) / (y[0] + y[1]), r12 = (y[1] - y[2]) / (y[1] + y[2]);
        const Complex t01 = 2.0 * y[0] / (y[0] + y[1]), t12 = 2.0 * y[1] / (y[1] + y[2]);
        const Complex sum = 1.0 + r01 * r12 * once * once;
        shares.reflected += 0.5 * std::norm((r01 + r12 * once * once) / sum);
        shares.transmitted +=
            surface.conductor ? 0.0 : 0.5 * y[2].real() / y[0].real() * std::norm(t01 * t12 * once / sum);
    }
    return shares;
}

/// The part of the BSDF, for radiance that reaches a camera outside, that does not depend on the wavelength, and the
/// facet's cosine, for a base of index 1.5 if it transmits; the surface's u and v run along x and y, its normal along
/// z.
struct Lobe {
    double geometry = 0.0; ///< [1/sr]
    double cosine = 0.0;
    bool reflected = true;
};
constexpr double glass_eta = 1.5;
cl_float2 alpha_of(const RoughSurface& surface) {
    return {{static_cast<float>(surface.alpha_u), static_cast<float>(surface.alpha_v)}};
}
Lobe lobe_of(const RoughSurface& surface, const V3d& to_camera, const V3d& to_light) {
    const Ggx ggx(alpha_of(surface));
    const Vec3 wo{to_camera.x, to_camera.y, to_camera.z}, wi{to_light.x, to_light.y, to_light.z};
    if (wi[2] > 0.0)
        return {ggx.reflection(wo, wi), kernel_test::dot(wo, Ggx::reflecting(wo, wi)), true};
    const Vec3 h = Ggx::refracting(wo, wi, glass_eta);
    if (surface.conductor || !Ggx::refracts(wo, wi, h))
        return {};
    return {ggx.refraction(wo, wi, glass_eta) / (glass_eta * glass_eta), kernel_test::dot(wo, h), false};
}
double share_of(const RoughSurface& surface, const Material& m, const Lobe& lobe, double lambda) {
    const Shares shares = interface_shares(surface, m, lambda, std::min(lobe.cosine, 1.0));
    return lobe.reflected ? shares.reflected : shares.transmitted;
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
    add_square_with_uv(scene, 2.0, material);
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
                const Lobe lobe = lobe_of(surface, -ray.direction, towards.normalized());
                return lobe.geometry * share_of(surface, m, lobe, lambda) * 3.0 * std::abs(towards.z) /
                       (d2 * std::sqrt(d2));
            });
        });
        exact.xyz.push_back(integrate_xyz(Spectrum::named("stdillum-D65"), value));
    }
    const RenderOptions options = small_render("tristimulus:4", width, height, 64, 0.01, 2);
    // 8×8 midpoints over pixels of 0.1 on lobes 0.05 wide, and lines over 10 nm of fringes hundreds of nm wide: 3e-3.
    expect_exact(std::string("highlight-") + GetParam().name, render_seeds(scene, options, 96, 4), exact, {3e-3, 0.02});
}

constexpr RoughSurface polished_coated{"coated", true, true, 0.04, 0.08},
    polished_glass{"glass", false, true, 0.05, 0.05};
INSTANTIATE_TEST_SUITE_P(Surfaces, PointHighlight,
                         testing::Values(Highlight{"coated_gold", polished_coated, false},
                                         Highlight{"glass_behind", polished_glass, true},
                                         Highlight{"rough_glass_behind", coated_glass, true}),
                         [](const testing::TestParamInfo<Highlight>& test) { return std::string(test.param.name); });

struct Mirrored {
    const char* name;
    double alpha_u, alpha_v;
    bool conductor, behind, infinite;
    double resolution = 0.02;
};
class SeenLight : public testing::TestWithParam<Mirrored> {};

constexpr double light_radiance = 5.0;

/// What comes from a square of that radiance, by 24×24 midpoints; geometry includes the solid angle and the cosine.
std::vector<Lobe> lobes_of_square(const RoughSurface& surface, const V3d& wo, const V3d& p, const V3d& corner,
                                  const V3d& edge_x, const V3d& edge_y) {
    constexpr int pieces = 24;
    std::vector<Lobe> lobes;
    for (int i = 0; i < pieces; ++i) {
        for (int j = 0; j < pieces; ++j) {
            const V3d towards = corner + (i + 0.5) / pieces * edge_x + (j + 0.5) / pieces * edge_y - p;
            const double d2 = towards.length2();
            const V3d wi = towards / std::sqrt(d2);
            Lobe lobe = lobe_of(surface, wo, wi);
            // The square is horizontal: its cosine is the surface's.
            lobe.geometry *= light_radiance * wi.z * wi.z / d2 * edge_x.length() * edge_y.length() / (pieces * pieces);
            if (lobe.geometry > 0.0)
                lobes.push_back(lobe);
        }
    }
    return lobes;
}

/// What comes from an environment of radiance 1, by 72×72 midpoints over the facets.
std::vector<Lobe> lobes_of_everything(const RoughSurface& surface, const V3d& to_camera) {
    constexpr int pieces = 72;
    const Ggx ggx(alpha_of(surface));
    const Vec3 wo{to_camera.x, to_camera.y, to_camera.z};
    const kernel_test::Lune lune(wo, alpha_of(surface));
    const double inverse = 1.0 / glass_eta;
    std::vector<Lobe> lobes;
    for (int i = 0; i < pieces; ++i) {
        for (int j = 0; j < pieces; ++j) {
            const auto [h, solid_angle] = lune.facet((i + 0.5) / pieces, (j + 0.5) / pieces);
            const double share = ggx.visible_pdf(wo, h) * solid_angle / (pieces * pieces);
            const double c = kernel_test::dot(wo, h);
            const Vec3 mirrored = 2.0 * c * h - wo;
            if (mirrored[2] > 0.0)
                lobes.push_back({share * ggx.masking_shadowing(wo, mirrored) / ggx.masking(wo), c, true});
            const Vec3 through = -inverse * wo + (inverse * c - std::sqrt(1.0 - (1.0 - c * c) * inverse * inverse)) * h;
            if (!surface.conductor && through[2] < 0.0)
                lobes.push_back(
                    {share * ggx.masking_shadowing(wo, through) / ggx.masking(wo) * inverse * inverse, c, false});
        }
    }
    return lobes;
}

/// Adds `scale` times the sum of lobes. Shares of power are joined by lines between 60 cosines.
void add_lobes(const RoughSurface& surface, const Material& m, const std::vector<Lobe>& lobes, double scale,
               Tabulated& sum) {
    double low = 1.0, high = 0.0;
    for (const Lobe& lobe : lobes) {
        low = std::min(low, lobe.cosine);
        high = std::max(high, lobe.cosine);
    }
    constexpr std::size_t steps = 60;
    std::array<std::array<double, 2>, steps + 1> weights{};
    for (const Lobe& lobe : lobes) {
        const double x = (lobe.cosine - low) / (high - low) * steps;
        const std::size_t i = std::min(static_cast<std::size_t>(x), steps - 1);
        const double f = x - static_cast<double>(i);
        const std::size_t kind = lobe.reflected ? 0 : 1;
        weights[i][kind] += lobe.geometry * (1.0 - f);
        weights[i + 1][kind] += lobe.geometry * f;
    }
    for (std::size_t w = 0; w < sum.value.size(); ++w) {
        for (std::size_t i = 0; i <= steps; ++i) {
            const double cosine = std::min(low + (high - low) * static_cast<double>(i) / steps, 1.0);
            const Shares shares = interface_shares(surface, m, 380.0 + 10.0 * static_cast<double>(w), cosine);
            sum.value[w] += scale * (weights[i][0] * shares.reflected + weights[i][1] * shares.transmitted);
        }
    }
}

/// An area light, or a uniform environment, reflected in a nearly specular surface (or seen through it), by light
/// sampling and by chance together: ∫ f cos over the light, and the albedo.
TEST_P(SeenLight, IsTheQuadrature) {
    if (GetParam().conductor && !long_tests())
        GTEST_SKIP() << "set TRISTIM_LONG_TESTS=1";
    constexpr int width = 3, height = 3;
    const RoughSurface surface{"", GetParam().conductor, true, GetParam().alpha_u, GetParam().alpha_v};
    Scene scene;
    scene.path = "seen";
    scene.camera = look_at({0.3, -1.6, 1.5}, {0, 0, 0}, {0, 0, 1}, 10.0);
    const int material = add_rough(scene, surface);
    add_square_with_uv(scene, 30.0, material);
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
        const int light = add_area_light(scene, Spectrum::named("stdillum-D65"), light_radiance);
        const int black = add_diffuse(scene, Spectrum::constant(0.0));
        if (GetParam().behind)
            add_parallelogram(scene, corner, edge_x, edge_y, black, light);
        else
            add_parallelogram(scene, corner, edge_y, edge_x, black, light);
    }
    const Material& m = scene.materials[static_cast<std::size_t>(material)];
    TestImage exact{width, height, {}};
    for (int pixel = 0; pixel < width * height; ++pixel) {
        constexpr int points = 3;
        Tabulated mean;
        for (int sub = 0; sub < points * points; ++sub) {
            const CameraRay ray = camera_ray(scene.camera, width, height, pixel % width + (sub % points + 0.5) / points,
                                             pixel / width + (sub / points + 0.5) / points);
            const V3d wo = -ray.direction;
            const std::vector<Lobe> lobes =
                GetParam().infinite ? lobes_of_everything(surface, wo)
                                    : lobes_of_square(surface, wo, at_height(ray, 0.0), corner, edge_x, edge_y);
            add_lobes(surface, m, lobes, 1.0 / (points * points), mean);
        }
        exact.xyz.push_back(integrate_xyz(Spectrum::named("stdillum-D65"), mean));
    }
    const RenderOptions options = small_render("tristimulus:4", width, height, 64, 0.01, 2);
    // 3×3 midpoints of a pixel and lines over 10 nm: 4e-3.
    expect_exact(std::string("seen-") + GetParam().name, render_seeds(scene, options, 256, 4), exact,
                 {4e-3, GetParam().resolution});
}

INSTANTIATE_TEST_SUITE_P(Surfaces, SeenLight,
                         testing::Values(Mirrored{"brushed_gold", 0.09, 0.04, true, false, false},
                                         Mirrored{"rough_gold", 0.3, 0.2, true, false, false},
                                         Mirrored{"glass_behind", 0.06, 0.06, false, true, false},
                                         Mirrored{"rough_glass_behind", 0.3, 0.3, false, true, false},
                                         Mirrored{"gold_in_the_open", 0.06, 0.09, true, false, true},
                                         Mirrored{"glass_in_the_open", 0.06, 0.06, false, false, true},
                                         // Its transmitted lobe is narrow, but no chance shares it with light sampling.
                                         Mirrored{"rough_glass_in_the_open", 0.3, 0.3, false, false, true, 0.1}),
                         [](const testing::TestParamInfo<Mirrored>& test) { return std::string(test.param.name); });

} // namespace
} // namespace tristim::test
