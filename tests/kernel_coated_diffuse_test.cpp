// Coated diffuse surfaces (kernels/coated_diffuse.h and internal_reflectance.h, meet_diffuse of both passes) against
// quadratures in double precision.

#include "interface_kernel.h"
#include "microfacet_oracle.h"

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>

namespace tristim {
namespace {

using namespace kernel_test;
using std::numbers::pi;

constexpr double film_error = 5e-6; ///< as in interface_surfaces.h

/// ∫ f(x) dx over [0, 1] by 2 × 64 nodes, whose pieces x = a s², 1 - b s² lie dense at both ends, where a film's values
/// have infinite slopes.
double dense_integral(const std::function<double(double)>& f) {
    static const std::vector<Node> rule = gauss_legendre(64);
    double sum = 0.0;
    for (const Node& node : rule) {
        const double s = node.x;
        sum += node.weight * s * (f(0.5 * s * s) + f(1.0 - 0.5 * s * s));
    }
    return sum;
}

/// ∫ R(μ) 2μ dμ of light from the base, in two parts about the critical angle.
double internal_reflectance(const CoatedSurface& surface, std::size_t w) {
    const double n = surface.n[w];
    const double critical = std::sqrt(std::max(0.0, 1.0 - 1.0 / (n * n)));
    const auto integrand = [&](double mu) { return surface.shares(w, mu, false).reflected * 2.0 * mu; };
    return dense_integral([&](double x) { return critical * integrand(critical * x); }) +
           dense_integral([&](double x) { return (1.0 - critical) * integrand(critical + (1.0 - critical) * x); });
}

std::vector<CoatedSurface> coated_surfaces() {
    const PerWavelength low{1.0F, 1.2F, 1.33F, 1.5F, 1.7F, 2.4F};
    const PerWavelength glass{1.5F, 1.5F, 1.5F, 1.5F, 1.5F, 1.5F};
    const PerWavelength film{1.45F, 1.5F, 1.33F, 1.8F, 2.2F, 2.5F};
    const PerWavelength none{}, some{0.01F, 0.05F, 0.1F, 0.5F, 2.0F, 0.001F};
    std::vector<CoatedSurface> surfaces;
    for (const double thickness : {0.0, 100.0, 350.0, 2000.0}) {
        for (const PerWavelength& base : {low, glass}) {
            for (const PerWavelength& k : {none, some}) {
                surfaces.push_back({fmt::format("{} nm on {}{}", thickness, base[0] == 1.0F ? "1 … 2.4" : "1.5",
                                                k[0] > 0.0F ? ", absorbing" : ""),
                                    MATERIAL_DIFFUSE,
                                    false,
                                    base,
                                    {},
                                    {{thickness, film, k}},
                                    {}});
            }
        }
    }
    surfaces.push_back(
        {"two layers on 1.5", MATERIAL_DIFFUSE, false, glass, {}, {{150.0, film, none}, {80.0, low, none}}, {}});
    return surfaces;
}

bool absorbs(const CoatedSurface& surface) {
    return surface.layers[0].k[0] > 0.0F;
}

/// Of internal_reflectance. Its 48 points, evaluated in double, are off by 2e-7, but by 7e-5 for 2 µm that absorb
/// weakly: light that such a film guides is lost at angles that are narrower than the rule's steps.
double internal_error(const CoatedSurface& surface) {
    return (absorbs(surface) && surface.layers[0].thickness > 1000.0 ? 8e-5 : 2e-6) + film_error;
}

const char* const coated_diffuse_source = R"(
#define PATH_SPECTRUM 1
#include "coated_diffuse.h"

kernel void coat(const global float* pass_table, const global SurfaceMaterial* material, const global SceneFilmLayer* layers,
                 const global float* cosines, global float* reflected, global float* transmitted, global float* body) {
    const size_t i = get_global_id(0);
    Scene scene;
    scene.pass_table = pass_table;
    scene.film_layers = layers;
    const InterfaceOptics optics = interface_optics(&scene, material, layers->thickness, true, cosines[i], SLOT_ALL);
    const Spectrum t = coat_transmittance(&scene, material, layers->thickness, cosines[i], SLOT_ALL);
    const Spectrum b = body_reflectance(&scene, material, layers->thickness, SLOT_ALL);
    for (int k = 0; k < BLOCKS; ++k) {
        vstorev(optics.reflected.block[k], k, reflected + i * W_PADDED);
        vstorev(t.block[k], k, transmitted + i * W_PADDED);
        vstorev(b.block[k], k, body + i * W_PADDED);
    }
}
)";

/// The pass table after film_tables.cl.
std::vector<float> filled_table(const CoatedSurface& surface, const PerWavelength& reflectance, bool absorbing) {
    Macros macros = interface_macros();
    for (auto& [name, value] : macros)
        value = name == "HAS_ABSORBING_FILM" && !absorbing ? "0" : value;
    Buffer<float> table = upload(pass_table_of(surface, reflectance));
    run(build_test_program("#include \"film_tables.cl\"\n", macros), "film_tables", 2,
        upload(std::vector{material_of(surface)}), upload(layers_of(surface)), 1, table,
        make_buffer<cl_uint>(2 * NON_FINITE_COUNTS));
    return table.read(test_device());
}

TEST(KernelCoatedDiffuse, InternalReflectanceIsTheQuadratures) {
    for (const CoatedSurface& surface : coated_surfaces()) {
        const std::vector<float> table = filled_table(surface, {}, absorbs(surface));
        for (std::size_t w = 0; w < test_wavelengths; ++w) {
            EXPECT_NEAR(table[(4 + internal_row) * padded_wavelengths + w], internal_reflectance(surface, w),
                        internal_error(surface))
                << surface.name << ", wavelength " << w;
        }
    }
}

/// Where a texture varies the thickness, F comes from a cubic between rows 4 nm apart. F is a sum of cosines of the
/// film's phase and its multiples. With n = 2.5 at 420 nm the phase turns by 4π n 4/λ = 0.3 from row to row, and
/// Lagrange's cubic is off by (9/384) 0.3⁴ = 2e-4 of the first cosine's amplitude; the second one's, 16 times that, may
/// be a sixteenth.
TEST(KernelCoatedDiffuse, InternalReflectanceBetweenItsRows) {
    constexpr int rows = 251;
    constexpr double last = 1000.0;
    for (CoatedSurface surface : coated_surfaces()) {
        if (absorbs(surface) || surface.layers[0].thickness > 0.0)
            continue;
        SurfaceMaterial material = material_of(surface);
        material.film_texture = 0;
        material.internal_reflectance = first_layer_row + 2;
        material.internal_rows = rows;
        material.internal_thickness = 0.0F;
        material.internal_step = static_cast<float>(last / (rows - 1));
        std::vector<float> table = pass_table_of(surface);
        table.resize(table.size() + rows * padded_wavelengths, 0.0F);
        const ::cl::Program program = build_test_program(R"(
#include "film_tables.cl"
kernel void interpolate(const global SurfaceMaterial* material, const global float* pass_table, const global float* thickness,
                        global float* values) {
    const size_t i = get_global_id(0);
    for (int b = 0; b < BLOCKS; ++b)
        vstorev(tabulated_internal_reflectance(pass_table, b, material, thickness[i]), b, values + i * W_PADDED);
}
)",
                                                         interface_macros());
        const Buffer<float> filled = upload(table);
        const Buffer<SurfaceMaterial> materials = upload(std::vector{material});
        run(program, "film_tables", 2 * rows, materials, upload(layers_of(surface)), rows, filled,
            make_buffer<cl_uint>(2 * NON_FINITE_COUNTS));
        std::vector<float> thicknesses{16.0F, 18.0F, 998.0F, 1000.0F};
        Random random(7);
        for (int i = 0; i < 24; ++i)
            thicknesses.push_back(static_cast<float>(random(16.0, last)));
        const Buffer<float> values = make_buffer<float>(thicknesses.size() * padded_wavelengths);
        run(program, "interpolate", thicknesses.size(), materials, filled, upload(thicknesses), values);
        const std::vector<float> found = values.read(test_device());
        for (std::size_t w = 0; w < test_wavelengths; ++w) {
            std::vector<double> expected;
            for (const float thickness : thicknesses) {
                surface.layers[0].thickness = thickness;
                expected.push_back(internal_reflectance(surface, w));
            }
            const auto [least, most] = std::minmax_element(expected.begin(), expected.end());
            for (std::size_t i = 0; i < thicknesses.size(); ++i)
                EXPECT_NEAR(found[i * padded_wavelengths + w], expected[i],
                            4e-4 * (*most - *least) + internal_error(surface))
                    << surface.name << ", " << thicknesses[i] << " nm, wavelength " << w;
        }
    }
}

/// Everything that falls on a film comes back: from its face R(θ), through it T(θ) ρ/(n² (1 - ρF)) ∫T 2μ dμ; with ρ = 1
/// and no absorption all of it.
TEST(KernelCoatedDiffuse, AlbedoIsTheClosedFormAndAWhiteBodyLosesNothing) {
    const ::cl::Program program = build_test_program(coated_diffuse_source, interface_macros());
    const std::vector<Node> rule = gauss_legendre(64);
    std::vector<float> cosines;
    for (const Node& node : rule) {
        cosines.push_back(static_cast<float>(0.5 * node.x * node.x));
        cosines.push_back(static_cast<float>(1.0 - 0.5 * node.x * node.x));
    }
    for (const CoatedSurface& surface : coated_surfaces()) {
        for (const PerWavelength& rho :
             {PerWavelength{1.0F, 1.0F, 1.0F, 1.0F, 1.0F, 1.0F}, PerWavelength{0.9F, 0.5F, 0.1F, 0.0F, 0.99F, 0.7F}}) {
            const std::size_t count = cosines.size();
            const Buffer<float> reflected = make_buffer<float>(count * padded_wavelengths),
                                transmitted = make_buffer<float>(count * padded_wavelengths),
                                body = make_buffer<float>(count * padded_wavelengths);
            run(program, "coat", count, upload(filled_table(surface, rho, true)),
                upload(std::vector{material_of(surface)}), upload(layers_of(surface)), upload(cosines), reflected,
                transmitted, body);
            const std::vector<float> r = reflected.read(test_device()), t = transmitted.read(test_device()),
                                     b = body.read(test_device());
            for (std::size_t w = 0; w < test_wavelengths; ++w) {
                double outwards = 0.0; // ∫ T(μ) 2μ dμ
                for (std::size_t i = 0; i < count; ++i)
                    outwards += rule[i / 2].weight * rule[i / 2].x * t[i * padded_wavelengths + w] * 2.0 * cosines[i];
                const double n2 = double{surface.n[w]} * surface.n[w];
                const double f = internal_reflectance(surface, w);
                const double expected_body = rho[w] / (n2 * (1.0 - rho[w] * f));
                double expected_outwards =
                    dense_integral([&](double mu) { return surface.shares(w, mu, true).transmitted * 2.0 * mu; });
                // An error e of F is e ρ/(1 - ρF) of the body's reflectance.
                const double body_error = internal_error(surface) * rho[w] / (1.0 - rho[w] * f) + 1e-6;
                ASSERT_NEAR(b[w], expected_body, expected_body * body_error) << surface.name << ", wavelength " << w;
                for (std::size_t i = 0; i < count; i += 7) {
                    const double albedo =
                        r[i * padded_wavelengths + w] + t[i * padded_wavelengths + w] * double{b[w]} * outwards;
                    const SharesOfPower s = surface.shares(w, cosines[i], true);
                    const double expected = s.reflected + s.transmitted * expected_body * expected_outwards;
                    ASSERT_NEAR(albedo, expected, body_error + 4.0 * film_error)
                        << surface.name << ", wavelength " << w << ", cosine " << cosines[i];
                    if (rho[w] == 1.0F && !absorbs(surface)) {
                        ASSERT_NEAR(albedo, 1.0, body_error + 4.0 * film_error)
                            << surface.name << ", wavelength " << w << ", cosine " << cosines[i];
                    }
                }
            }
        }
    }
}

/// Both passes at a coated diffuse surface, called as the passes call them.
const char* const eye_source = R"(
kernel void meet(const global float* pass_table, const global SurfaceMaterial* material, const global SceneFilmLayer* layers,
                 float cosine, int slot, const global float4* u, global float* weights) {
    const size_t i = get_global_id(0);
    const Scene scene = scene_of(pass_table, layers);
    const Interaction it = surface_at((float3)(0.0f, 0.0f, 1.0f), (float3)(0.0f));
    EyePath path;
    path.direction = (float3)(sqrt(1.0f - cosine * cosine), 0.0f, -cosine);
    path.weight = first_weight(slot);
    path.pdf = 1.0f;
    path.radiance = 0.0f;
    EyeEnd end;
    const bool goes_on = meet_diffuse(&scene, material, &it, u[i].x, 0.5f, (float2)(0.5f), &path, &end);
    store_path(goes_on ? 1.0f : 0.0f, path.direction.z, &path.weight, weights + i * (3 + W_PADDED));
}
)";
const char* const photon_source = R"(
kernel void meet(const global float* pass_table, const global SurfaceMaterial* material, const global SceneFilmLayer* layers,
                 float cosine, int slot, const global float4* u, global float* weights, global Photon* photons,
                 global PhotonSurface* surfaces, global float* spectra) {
    const size_t i = get_global_id(0);
    const Scene scene = scene_of(pass_table, layers);
    const Interaction it = surface_at((float3)(0.0f, 0.0f, 1.0f), (float3)(0.0f));
    PhotonPath path;
    path.direction = (float3)(sqrt(1.0f - cosine * cosine), 0.0f, -cosine);
    path.weight = first_weight(slot);
    path.bounced = false;
    path.first_bounce = u[i].yz;
    path.key = pcg4d((uint4)((uint)i, 1u, 2u, 3u));
    PhotonStore store = {photons, surfaces, spectra, (uint)i, (uint)i + 1u};
    const bool goes_on = meet_diffuse(&scene, material, &it, true, 0u, &path, &store);
    store_path(goes_on ? (path.bounced ? 2.0f : 1.0f) : 0.0f, path.direction.z, &path.weight, weights + i * (3 + W_PADDED));
}
)";

struct Met {
    bool goes_on, bounced;
    double z;
    std::array<double, test_wavelengths> weight;
};
std::vector<Met> read_met(const Buffer<float>& buffer, std::size_t count, int slot) {
    const std::vector<float> values = buffer.read(test_device());
    std::vector<Met> result;
    for (std::size_t i = 0; i < count; ++i) {
        const float* v = values.data() + i * (3 + padded_wavelengths);
        Met met{v[0] > 0.0F, v[0] > 1.0F, v[1], {}};
        for (std::size_t w = 0; w < test_wavelengths; ++w)
            met.weight[w] = double{v[2]} * (slot < 0 ? v[3 + w] : slot == static_cast<int>(w) ? 1.0F : 0.0F);
        result.push_back(met);
    }
    return result;
}

TEST(KernelCoatedDiffuse, CameraAndPhotonPathsMeetTheSameSurface) {
    constexpr std::size_t count = 1 << 15;
    Macros direct = interface_macros(); // no light to sample
    direct.emplace_back("DIRECT_PHOTONS", "1");
    const ::cl::Program eye = build_test_program("#include \"eye_pass.cl\"\n" + path_source + eye_source, direct),
                        photon =
                            build_test_program("#include \"photon_pass.cl\"\n" + path_source + photon_source, direct);
    const PerWavelength rho{0.9F, 0.5F, 0.1F, 1.0F, 0.8F, 0.7F};
    const std::vector<cl_float4> u = random_hypercubes(count, 75);
    const std::vector<CoatedSurface> surfaces = coated_surfaces();
    for (const CoatedSurface& surface : {surfaces[5], surfaces[10], surfaces[16]}) {
        const std::vector<float> table = filled_table(surface, rho, true);
        for (const float cosine : {0.9F, 0.15F}) {
            for (const int slot : {SLOT_ALL, 2}) {
                const std::string where = fmt::format("{}, cosine {}, slot {}", surface.name, cosine, slot);
                const Buffer<float> eye_weights = make_buffer<float>(count * (3 + padded_wavelengths)),
                                    photon_weights = make_buffer<float>(count * (3 + padded_wavelengths)),
                                    spectra = make_buffer<float>(count * padded_wavelengths);
                const Buffer<Photon> photons = make_buffer<Photon>(count);
                run(eye, "meet", count, upload(table), upload(std::vector{material_of(surface)}),
                    upload(layers_of(surface)), cosine, slot, upload(u), eye_weights);
                run(photon, "meet", count, upload(table), upload(std::vector{material_of(surface)}),
                    upload(layers_of(surface)), cosine, slot, upload(u), photon_weights, photons,
                    make_buffer<PhotonSurface>(1), spectra);
                const std::vector<Met> seen = read_met(eye_weights, count, slot),
                                       flown = read_met(photon_weights, count, slot);
                const std::vector<float> stored = spectra.read(test_device());
                const std::vector<Photon> stored_photons = photons.read(test_device());
                for (std::size_t w = 0; w < test_wavelengths; ++w) {
                    if (slot >= 0 && slot != static_cast<int>(w))
                        continue;
                    const double before = slot < 0 ? first_weights[w] : 1.0;
                    const SharesOfPower s = surface.shares(w, cosine, true);
                    const double n2 = double{surface.n[w]} * surface.n[w];
                    const double body = rho[w] / (n2 * (1.0 - rho[w] * internal_reflectance(surface, w)));
                    const double outwards =
                        dense_integral([&](double mu) { return surface.shares(w, mu, true).transmitted * 2.0 * mu; });
                    const double outwards_z = dense_integral(
                        [&](double mu) { return surface.shares(w, mu, true).transmitted * 2.0 * mu * mu; });
                    Moments eye_mirrored, eye_entered, photon_mirrored, photon_scattered, photon_scattered_z;
                    for (std::size_t i = 0; i < count; ++i) {
                        eye_mirrored.add(seen[i].goes_on ? seen[i].weight[w] : 0.0);
                        eye_entered.add(seen[i].goes_on ? 0.0 : seen[i].weight[w]);
                        const bool mirrored = flown[i].goes_on && !flown[i].bounced;
                        photon_mirrored.add(mirrored ? flown[i].weight[w] : 0.0);
                        const double scattered = flown[i].goes_on && flown[i].bounced ? flown[i].weight[w] : 0.0;
                        photon_scattered.add(scattered);
                        photon_scattered_z.add(scattered * flown[i].z);
                        if (mirrored) {
                            ASSERT_NEAR(flown[i].z, cosine, 2e-6) << where;
                        }
                    }
                    const double error = before * 4e-5;
                    const auto expect = [&](const char* what, const Moments& moments, double expected) {
                        expect_mean(fmt::format("{}, wavelength {}: {}", where, w, what), moments.mean(), expected,
                                    moments.standard_error(), error);
                    };
                    expect("camera paths reflected", eye_mirrored, before * s.reflected);
                    expect("camera paths that enter", eye_entered, before * s.transmitted);
                    expect("photons reflected", photon_mirrored, before * s.reflected);
                    expect("photons scattered", photon_scattered, before * s.transmitted * body * outwards);
                    expect("their cosine", photon_scattered_z, before * s.transmitted * body * outwards_z);
                    const double expected_flux = before * s.transmitted * body / pi;
                    const double flux = slot < 0 ? stored[w] : stored_photons[0].flux_y; // of weights 1
                    EXPECT_NEAR(flux, expected_flux, before * 4e-5) << where << ", wavelength " << w;
                }
            }
        }
    }
}

} // namespace
} // namespace tristim
