// Light through a glass prism lands where Snell's law in double precision says, at ten wavelengths.

#include "kernel_harness.h"
#include "render/renderer.h"

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>
#include <optional>

namespace tristim {
namespace {

using namespace kernel_test;
using std::numbers::pi;

constexpr std::array<double, 10> wavelengths_nm{400, 433, 467, 500, 533, 567, 600, 633, 667, 700};

const Spectrum& glass() {
    static const Spectrum spectrum = Spectrum::named("glass-F11");
    return spectrum;
}

// An equilateral prism of side 1, apex up, along z. The beam meets its left face in the middle, rising by 33.5°, close
// to the least deviation, and leaves the right one sinking by as much. The screen lies across it, 4 away.
const Vec3 left_normal{-std::sqrt(0.75), 0.5, 0.0};
const Vec3 right_normal{std::sqrt(0.75), 0.5, 0.0};
const Vec3 left_point{-0.25, std::sqrt(0.1875), 0.0};
const Vec3 right_point{0.25, std::sqrt(0.1875), 0.0};
constexpr double rise = 33.5 * pi / 180.0;
const Vec3 beam{std::cos(rise), std::sin(rise), 0.0};
const Vec3 screen_normal{-std::cos(rise), std::sin(rise), 0.0};
const Vec3 screen_up{std::sin(rise), std::cos(rise), 0.0};
const Vec3 screen_centre = right_point - 4.0 * screen_normal;
const Vec3 source = left_point - 2.0 * beam;
constexpr double cone_degrees = 0.2;

V3f to_v3f(const Vec3& v) {
    return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

void add_quad(Mesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec3& corner : {a, b, c, d})
        mesh.positions.push_back(to_v3f(corner));
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
}

Scene prism_scene() {
    Scene scene;
    scene.path = "prism";
    Material dielectric;
    dielectric.kind = Material::Kind::Dielectric;
    dielectric.eta = glass();
    Material black; // what reaches the screen is stored and goes no further
    black.reflectance = Spectrum::constant(0.0);
    scene.materials = {dielectric, black};

    // The sides alone: the beam never comes near the ends at z = ±1.
    const Vec3 apex{0.0, std::sqrt(0.75), 0.0}, left{-0.5, 0.0, 0.0}, right{0.5, 0.0, 0.0}, depth{0.0, 0.0, 1.0};
    Shape prism;
    const auto side = [&](const Vec3& a, const Vec3& b) { // outside on the right of a → b seen from +z
        add_quad(prism.mesh, a + depth, a - depth, b - depth, b + depth);
    };
    side(apex, left);
    side(left, right);
    side(right, apex);
    Shape screen;
    screen.material = 1;
    add_quad(screen.mesh, screen_centre - 0.8 * screen_up - depth, screen_centre + 0.8 * screen_up - depth,
             screen_centre + 0.8 * screen_up + depth, screen_centre - 0.8 * screen_up + depth);
    scene.shapes = {prism, screen};

    Light spot;
    spot.kind = Light::Kind::Spot;
    spot.emission = Spectrum::named("stdillum-D65");
    spot.position = {source[0], source[1], source[2]};
    spot.direction = {beam[0], beam[1], beam[2]};
    spot.cos_total_width = spot.cos_falloff_start = std::cos(cone_degrees * pi / 180.0);
    scene.lights = {spot};
    return scene;
}

/// Snell's law for a ray that meets a plane of normal n on the side that n points to; eta beyond over here. And the
/// share that passes.
struct Refracted {
    Vec3 direction;
    double transmittance;
};
Refracted refract(const Vec3& direction, const Vec3& n, double eta) {
    const double cos_i = -dot(direction, n);
    const double cos_t = std::sqrt(1.0 - (1.0 - cos_i * cos_i) / (eta * eta));
    const double s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    const double p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    return {(1.0 / eta) * (direction + cos_i * n) - cos_t * n, 1.0 - 0.5 * (s * s + p * p)};
}

Vec3 meet(const Vec3& origin, const Vec3& direction, const Vec3& point, const Vec3& n) {
    return origin + (dot(point - origin, n) / dot(direction, n)) * direction;
}

struct Landing {
    double height; ///< on the screen, along screen_up
    Vec3 direction;
    double transmittance;
};
Landing through_the_prism(const Vec3& direction, double eta) {
    const Vec3 entry = meet(source, direction, left_point, left_normal);
    const Refracted inside = refract(direction, left_normal, eta);
    const Vec3 exit = meet(entry, inside.direction, right_point, right_normal);
    const Refracted outside = refract(inside.direction, -1.0 * right_normal, 1.0 / eta);
    const Vec3 end = meet(exit, outside.direction, screen_centre, screen_normal);
    return {dot(end - screen_centre, screen_up), outside.direction, inside.transmittance * outside.transmittance};
}

/// The tracing kernels' own path from the light on: nearest hit, scattering by refraction alone, next hit.
TEST(Prism, ExitDirectionsFollowSnellsLaw) {
    const ::cl::Program program = build_test_program(
        R"(
#define PATH_SPECTRUM 0
#include "bsdf.h"
kernel void follow(SCENE_PARAMETERS, float3 origin, float3 direction, global float4* out) {
    SCENE_FROM_PARAMETERS;
    const int slot = (int)get_global_id(0);
    PathWeight weight;
    weight.scale = 1.0f;
    weight.slot = SLOT_ALL;
    int refractions = 0;
    out[3 * slot] = 0.0f;
    for (;;) {
        const Hit hit = closest_hit(&scene, origin, direction);
        if (hit.triangle < 0)
            break;
        const Interaction it = make_interaction(&scene, &hit);
        if (materials[it.material].kind == MATERIAL_DIFFUSE) {
            out[3 * slot] = (float4)(it.point, (float)refractions);
            break;
        }
        // 1 - 2^-24 reflects only what is reflected totally.
        float pdf;
        scatter(&scene, materials + it.material, &it, &direction, 0x1.fffffep-1f, slot, false, &weight, &pdf);
        origin = leave_surface(&it, direction);
        ++refractions;
    }
    out[3 * slot + 1] = (float4)(direction, (float)weight.slot);
    out[3 * slot + 2] = (float4)(weight.scale, 0.0f, 0.0f, 0.0f);
}
)",
        {{"W", "10"}, {"LANES", "16"}, {"BLOCKS", "1"}, {"HAS_DIELECTRIC", "1"}, {"HAS_DISPERSION", "1"}});
    const FlatScene flat = flatten_scene(prism_scene(), derive_effects(prism_scene()), 1, 1, {0, 0, 1, 1});
    const SceneBuffers buffers(kernel_test::test_device(), flat);
    // Rows of 16: four of wavelengths and weights, then the spectra, of which the materials name the glass's.
    std::vector<float> table(16 * (4 + static_cast<std::size_t>(flat.spectra.rows())), 0.0F);
    for (std::size_t w = 0; w < wavelengths_nm.size(); ++w)
        table[16 * (4 + static_cast<std::size_t>(flat.materials[0].eta)) + w] =
            static_cast<float>(glass()(wavelengths_nm[w]));
    const Buffer<float> pass_table = upload(table);
    const RayRecorder recorder(kernel_test::test_device(), 0);
    const Buffer<cl_float4> output = make_buffer<cl_float4>(3 * wavelengths_nm.size());
    ::cl::Kernel kernel(program, "follow");
    cl_uint index = buffers.bind(kernel, pass_table, recorder);
    const V3f from = to_v3f(source), along = to_v3f(beam);
    set_argument(kernel, index++, cl_float3{{from.x, from.y, from.z}});
    set_argument(kernel, index++, cl_float3{{along.x, along.y, along.z}});
    set_argument(kernel, index++, output);
    kernel_test::test_device().queue.enqueueNDRangeKernel(kernel, ::cl::NullRange,
                                                          ::cl::NDRange(wavelengths_nm.size()));
    const std::vector<cl_float4> results = output.read(kernel_test::test_device());

    for (std::size_t w = 0; w < wavelengths_nm.size(); ++w) {
        const Landing expected = through_the_prism(beam, glass()(wavelengths_nm[w]));
        const std::string at = fmt::format("{} nm", wavelengths_nm[w]);
        ASSERT_EQ(results[3 * w].s[3], 2.0F) << at << ": two refractions before the screen";
        EXPECT_EQ(results[3 * w + 1].s[3], static_cast<float>(w)) << at << ": slot";
        EXPECT_EQ(results[3 * w + 2].s[0], 10.0F) << at << ": weight of one wavelength of ten";
        // KernelOptics.RaysFollowSnellsLaw bounds each refraction: 30 units on entry, 90 on exit (cos θ > 0.38 there),
        // and 10 for the rounded normals and index; the second magnifies the first's by eta cos θ / cos θ_t, at
        // most 4.2.
        constexpr double tolerance = (4.2 * 40.0 + 100.0) * unit_roundoff;
        const double angle = length(vec3(results[3 * w + 1]) - expected.direction);
        EXPECT_LT(angle, tolerance) << at << ": the exit direction is off by " << angle << " rad";
        // Over 4 units of length, and positions of up to 5 rounded and moved off surfaces by 256 units twice.
        const double height = dot(vec3(results[3 * w]) - screen_centre, screen_up);
        EXPECT_NEAR(height, expected.height, 4.0 * tolerance + 4.0 * 256.0 * 0x1p-22) << at << ": height on the screen";
    }
    EXPECT_GT(through_the_prism(beam, glass()(700)).height - through_the_prism(beam, glass()(400)).height, 0.1)
        << "the spectrum must be far wider than the tolerance";
}

/// The mean landing height of a cone of light around the beam, weighted by what passes both faces.
double mean_height(double eta) {
    const auto [s, t] = tangents(beam);
    const double cos_cone = static_cast<float>(std::cos(cone_degrees * pi / 180.0));
    double sum = 0.0, weights = 0.0;
    constexpr int rings = 16, turns = 32;
    for (int ring = 0; ring < rings; ++ring) {
        for (int i = 0; i < turns; ++i) {
            const double cosine = 1.0 - (1.0 - cos_cone) * (ring + 0.5) / rings;
            const double sine = std::sqrt(1.0 - cosine * cosine), angle = 2.0 * pi * (i + 0.5) / turns;
            const Landing landing =
                through_the_prism(cosine * beam + sine * std::cos(angle) * s + sine * std::sin(angle) * t, eta);
            sum += landing.transmittance * landing.height;
            weights += landing.transmittance;
        }
    }
    return sum / weights;
}

TEST(Prism, RenderedSpectrumLandsWhereSnellsLawSays) {
    const Scene scene = prism_scene();
    RenderOptions options;
    options.method = parse_method("spectral:400");
    options.width = options.height = 1;
    options.region = {0, 0, 1, 1};
    options.photons_per_pass = 16384;
    options.max_depth = 4;
    options.radius = 0.1;
    options.seed = 5;
    Renderer renderer(scene, options, kernel_test::test_device());

    constexpr int passes = 6;
    constexpr int slots_around = 2; // a wavelength's photons are those of five bins of 1 nm
    const double spread =
        8.0 * 2.0 * std::sin(cone_degrees * pi / 180.0); // far more than a cone spreads over 6 units of length
    std::array<Moments, wavelengths_nm.size()> residuals;
    std::array<double, wavelengths_nm.size()> landed{}, emitted{}, transmittances{};
    for (std::uint32_t pass = 0; pass < passes; ++pass) {
        renderer.render_pass(pass);
        const std::vector<float> table = renderer.pass_table();
        std::array<std::vector<double>, wavelengths_nm.size()> heights; // expected, for each slot of the group
        for (std::size_t w = 0; w < wavelengths_nm.size(); ++w) {
            const auto centre = static_cast<std::size_t>(wavelengths_nm[w] - lambda_min_nm);
            for (std::size_t slot = centre - slots_around; slot <= centre + slots_around; ++slot) {
                const double lambda = table[slot];
                ASSERT_NEAR(lambda, wavelengths_nm[w], slots_around + 1.0);
                heights[w].push_back(mean_height(glass()(lambda)));
                emitted[w] += options.photons_per_pass / 400.0;
            }
            transmittances[w] = through_the_prism(beam, glass()(wavelengths_nm[w])).transmittance;
        }
        for (const Photon& photon : renderer.photons()) {
            const double height = dot(Vec3{photon.x, photon.y, photon.z} - screen_centre, screen_up);
            for (std::size_t w = 0; w < wavelengths_nm.size(); ++w) {
                const int first = static_cast<int>(wavelengths_nm[w] - lambda_min_nm) - slots_around;
                const int within = photon.slot - first;
                if (within < 0 || within > 2 * slots_around)
                    continue;
                const double residual = height - heights[w][static_cast<std::size_t>(within)];
                if (std::abs(residual) > spread)
                    continue; // reflected inside the prism first
                residuals[w].add(residual);
                landed[w] += 1.0;
            }
        }
    }
    for (std::size_t w = 0; w < wavelengths_nm.size(); ++w) {
        const double share = landed[w] / emitted[w];
        // Photons choose slots by a low-discrepancy sequence: their numbers vary less than binomially.
        expect_mean(fmt::format("share of {} nm that reaches the screen", wavelengths_nm[w]), share, transmittances[w],
                    std::sqrt(transmittances[w] / emitted[w]));
        // The index is linear between means of 1 nm (1e-5 off at most in the tables' steps of 2 nm), over 4 units of
        // length at a slope of 2; positions as above.
        expect_mean(fmt::format("landing height of {} nm", wavelengths_nm[w]), residuals[w].mean(), 0.0,
                    residuals[w].standard_error(), 12.0 * 1e-5 + 4.0 * 256.0 * 0x1p-22);
        EXPECT_LT(residuals[w].standard_error(), 5e-4) << "too few photons to tell the wavelengths apart";
    }
}

} // namespace
} // namespace tristim
