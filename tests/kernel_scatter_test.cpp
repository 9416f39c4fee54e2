// scatter_dielectric and scatter_conductor of kernels/bsdf.h: choices, directions, and weights of both kinds of
// transport.

#include "kernel_harness.h"
#include "shared_types.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>

namespace tristim {
namespace {

using namespace kernel_test;
using std::numbers::pi;

const char* const scatter_source = R"(
#define PATH_SPECTRUM 1
#include "bsdf.h"

PathWeight new_weight(int slot) {
    PathWeight weight;
    weight.scale = 1.0f;
    weight.slot = slot;
    weight.spectrum.block[0] = (floatv)(2.0f, 3.0f, 5.0f, 0.0f);
    return weight;
}
Interaction plane(float3 normal) {
    Interaction it;
    it.point = 0.0f;
    it.normal = it.shading_normal = normal;
    it.extent = 1.0f;
    it.material = 0;
    it.light = -1;
    return it;
}
kernel void dielectric(const global float* pass_table, const global SurfaceMaterial* material, const global float4* directions,
                       const global float* u, float3 normal, int old_slot, int slot, int radiance, global float4* scattered,
                       global float4* weights) {
    const size_t i = get_global_id(0);
    Scene scene;
    scene.pass_table = pass_table;
    const Interaction it = plane(normal);
    PathWeight weight = new_weight(old_slot);
    float3 d = directions[i].xyz;
    float pdf;
    scatter(&scene, material, &it, &d, u[i], slot, radiance != 0, &weight, &pdf);
    scattered[i] = (float4)(d, 0.0f);
    weights[i] = (float4)(weight.scale, (float)weight.slot, weight.spectrum.block[0].x, weight.spectrum.block[0].y);
}
kernel void conductor(const global float* pass_table, const global SurfaceMaterial* material, const global float4* directions,
                      float3 normal, int old_slot, global float4* scattered, global float4* weights) {
    const size_t i = get_global_id(0);
    Scene scene;
    scene.pass_table = pass_table;
    const Interaction it = plane(normal);
    PathWeight weight = new_weight(old_slot);
    scattered[i] = (float4)(scatter_conductor(&scene, material, &it, directions[i].xyz, &weight), weight.scale);
    weights[i] = weight.spectrum.block[0];
}
// From above through a slab between z = 0 (normal up) and z = -1 (normal down): where it ends and with which weight.
kernel void slab(const global float* pass_table, const global SurfaceMaterial* material, float3 direction, uint seed, int radiance,
                 global float4* ends) {
    const uint i = (uint)get_global_id(0);
    Scene scene;
    scene.pass_table = pass_table;
    PathWeight weight = new_weight(SLOT_ALL);
    float3 d = direction;
    bool top = true;
    int depth = 0;
    for (; depth < 100; ++depth) {
        const Interaction it = plane((float3)(0.0f, 0.0f, top ? 1.0f : -1.0f));
        const float u = random4(seed, 0u, i, (uint)depth).x;
        float pdf;
        scatter(&scene, material, &it, &d, u, 0, radiance != 0, &weight, &pdf);
        if (d.z > 0.0f == top)
            break;
        top = d.z > 0.0f;
    }
    ends[i] = (float4)(d, weight.scale);
}
)";

const Macros macros{{"HAS_DIELECTRIC", "1"}, {"HAS_DISPERSION", "1"}, {"HAS_CONDUCTOR", "1"}, {"W", "3"},
                    {"LANES", "4"},          {"BLOCKS", "1"}};

/// A pass table of three wavelengths with two spectra: eta in row 0, k in row 1.
std::vector<float> table(const std::array<float, 3>& eta, const std::array<float, 3>& k = {}) {
    std::vector<float> values(4 * 4, 0.0F);
    for (const std::array<float, 3>& row : {eta, k}) {
        values.insert(values.end(), row.begin(), row.end());
        values.push_back(0.0F);
    }
    return values;
}

SurfaceMaterial dielectric(bool dispersive) {
    SurfaceMaterial material{};
    material.kind = MATERIAL_DIELECTRIC;
    material.dispersive = dispersive ? 1 : 0;
    return material;
}

cl_float3 float3_of(const Vec3& v) {
    return {{static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])}};
}
cl_float4 float4_of(const Vec3& v) {
    return {{static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]), 0.0F}};
}

double fresnel(double cos_i, double eta) {
    const double cos2_t = 1.0 - (1.0 - cos_i * cos_i) / (eta * eta);
    if (cos2_t <= 0.0)
        return 1.0;
    const double cos_t = std::sqrt(cos2_t);
    const double s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    const double p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    return 0.5 * (s * s + p * p);
}

class KernelScatter : public ::testing::Test {
  protected:
    struct Scattered {
        std::vector<cl_float4> directions, weights;
    };

    Scattered scatter(const std::array<float, 3>& eta, bool dispersive, const std::vector<cl_float4>& directions,
                      const Vec3& normal, int old_slot, int slot, bool radiance, std::uint32_t seed) const {
        Random random(seed);
        std::vector<float> u(directions.size());
        for (float& value : u)
            value = random();
        const Buffer<cl_float4> scattered = make_buffer<cl_float4>(u.size()),
                                weights = make_buffer<cl_float4>(u.size());
        run(program_, "dielectric", u.size(), upload(table(eta)), upload(std::vector{dielectric(dispersive)}),
            upload(directions), upload(u), float3_of(normal), old_slot, slot, radiance ? 1 : 0, scattered, weights);
        return {scattered.read(test_device()), weights.read(test_device())};
    }

    const ::cl::Program program_ = build_test_program(scatter_source, macros);
};

TEST_F(KernelScatter, ReflectsByChanceOfTheReflectanceFromBothSides) {
    const Vec3 normal = normalized({0.48, -0.6, 0.64});
    const auto [s, t] = tangents(normal);
    for (const float eta : {1.5F, 2.4F}) {
        for (const double degrees : {5.0, 40.0, 60.0, 80.0, 88.0}) {
            for (const bool entering : {true, false}) {
                const double cosine = std::cos(degrees * pi / 180.0), sine = std::sin(degrees * pi / 180.0);
                const Vec3 direction = (entering ? -cosine : cosine) * normal + sine * (0.6 * s + 0.8 * t);
                const double relative = entering ? eta : 1.0 / eta;
                const Scattered result =
                    scatter({eta, eta, eta}, false, std::vector<cl_float4>(1 << 15, float4_of(direction)), normal,
                            SLOT_ALL, 0, false, 31);
                Histogram histogram(2);
                int refracted = 0;
                for (std::size_t i = 0; i < result.directions.size(); ++i) {
                    const Vec3 d = vec3(result.directions[i]);
                    const bool reflected = dot(d, normal) * dot(direction, normal) < 0.0;
                    histogram.add(reflected ? 0 : 1);
                    refracted += reflected ? 0 : 1;
                    const Vec3 expected = reflected
                                              ? direction - 2.0 * dot(direction, normal) * normal
                                              : (1.0 / relative) * sine * (0.6 * s + 0.8 * t) +
                                                    (entering ? -1.0 : 1.0) *
                                                        std::sqrt(1.0 - sine * sine / (relative * relative)) * normal;
                    // The bound of KernelOptics.RaysFollowSnellsLaw for cos_t > 0.1.
                    ASSERT_LT(length(d - expected), 200.0 * unit_roundoff)
                        << "eta " << relative << ", " << degrees << "°";
                    ASSERT_EQ(result.weights[i].s[0], 1.0F) << "a photon's flux must stay";
                    ASSERT_EQ(result.weights[i].s[1], -1.0F) << "no slot without dispersion";
                }
                const double reflectance = fresnel(cosine, relative);
                if (reflectance < 1.0) {
                    histogram.expect_distribution(fmt::format("reflection at eta = {}, {}°", relative, degrees),
                                                  {reflectance, 1.0 - reflectance});
                } else {
                    EXPECT_EQ(refracted, 0) << "total reflection at eta = " << relative << ", " << degrees << "°";
                }
            }
        }
    }
}

/// Radiance scales by (η_t/η_i)² along light, so a camera path, which runs against it, takes 1/η² into the glass and η²
/// out of it.
TEST_F(KernelScatter, RadianceScalesByTheSquaredIndexAndFluxDoesNot) {
    const Vec3 normal{0.0, 0.0, 1.0};
    for (const float eta : {0.8F, 1.5F, 2.4F}) {
        for (const bool radiance : {false, true}) {
            for (const double z : {-0.95, 0.95}) {
                const Vec3 direction{std::sqrt(1.0 - z * z), 0.0, z};
                const Scattered result =
                    scatter({eta, eta, eta}, false, std::vector<cl_float4>(4096, float4_of(direction)), normal,
                            SLOT_ALL, 0, radiance, 32);
                const double squared = double{eta} * eta;
                const double factor = !radiance ? 1.0 : z < 0.0 ? 1.0 / squared : squared;
                std::size_t refracted = 0;
                for (std::size_t i = 0; i < result.directions.size(); ++i) {
                    const bool through = result.directions[i].s[2] * z > 0.0;
                    refracted += through ? 1 : 0;
                    // 1/eta, its square and the division: 5 + 5 + 1 + 5 units.
                    ASSERT_NEAR(result.weights[i].s[0], through ? factor : 1.0, 16.0 * unit_roundoff * factor)
                        << "eta " << eta << (through ? ", refracted" : ", reflected")
                        << (radiance ? ", radiance" : ", flux");
                }
                EXPECT_GT(refracted, 3000U);
            }
        }
    }
}

/// Uniform radiance 1 outside. The flux that photons bring into the glass per area is π ∫(1 - F) 2 cos θ d(cos θ) over
/// directions outside; what camera paths inside see, integrated over the irradiance they stand for, must be the same.
TEST_F(KernelScatter, BothTransportsFindTheSameFlux) {
    constexpr std::size_t count = 1 << 17;
    const Vec3 normal{0.0, 0.0, 1.0};
    for (const float eta : {1.33F, 2.0F}) {
        std::vector<cl_float4> from_outside, from_inside;
        Random random(33);
        for (std::size_t i = 0; i < count; ++i) {
            const double squared = random(0.0, 1.0), angle = random(0.0, 2.0 * pi), sine = std::sqrt(1.0 - squared);
            const double z = std::sqrt(squared);
            from_outside.push_back(float4_of({sine * std::cos(angle), sine * std::sin(angle), -z}));
            from_inside.push_back(float4_of({sine * std::cos(angle), sine * std::sin(angle), z}));
        }
        const Scattered photons = scatter({eta, eta, eta}, false, from_outside, normal, SLOT_ALL, 0, false, 34);
        const Scattered camera = scatter({eta, eta, eta}, false, from_inside, normal, SLOT_ALL, 0, true, 35);
        Moments photon_flux, camera_flux;
        for (std::size_t i = 0; i < count; ++i) {
            photon_flux.add(photons.directions[i].s[2] < 0.0F ? double{photons.weights[i].s[0]} : 0.0);
            camera_flux.add(camera.directions[i].s[2] > 0.0F ? double{camera.weights[i].s[0]} : 0.0);
        }
        double expected = 0.0;
        constexpr int steps = 20000;
        for (int i = 0; i < steps; ++i) {
            const double cosine = (i + 0.5) / steps;
            expected += (1.0 - fresnel(cosine, eta)) * 2.0 * cosine / steps;
        }
        expect_mean(fmt::format("photons into eta = {}", eta), photon_flux.mean(), expected,
                    photon_flux.standard_error());
        expect_mean(fmt::format("camera paths out of eta = {}", eta), camera_flux.mean(), expected,
                    camera_flux.standard_error());
    }
}

/// An infinite number of reflections between the faces: (1-F)/(1+F) passes through. Whatever leaves, on either side,
/// carries the weight it came with.
TEST_F(KernelScatter, SlabTransmitsAndGivesRadianceBack) {
    constexpr std::size_t count = 1 << 16;
    const float eta = 1.8F;
    for (const double degrees : {0.0, 50.0, 75.0}) {
        const double cosine = std::cos(degrees * pi / 180.0);
        const Vec3 direction{std::sin(degrees * pi / 180.0), 0.0, -cosine};
        const double f = fresnel(cosine, eta);
        for (const int radiance : {0, 1}) {
            const Buffer<cl_float4> output = make_buffer<cl_float4>(count);
            run(program_, "slab", count, upload(table({eta, eta, eta})), upload(std::vector{dielectric(false)}),
                float3_of(direction), cl_uint{36}, radiance, output);
            Histogram histogram(2);
            for (const cl_float4& end : output.read(test_device())) {
                histogram.add(end.s[2] < 0.0F ? 1 : 0);
                ASSERT_NEAR(end.s[3], 1.0, radiance != 0 ? 32.0 * unit_roundoff : 0.0) << degrees << "°";
                const Vec3 expected = end.s[2] < 0.0F ? direction : Vec3{direction[0], 0.0, -direction[2]};
                ASSERT_LT(length(vec3(end) - expected), 1e-5) << degrees << "°: parallel faces keep directions";
            }
            histogram.expect_distribution(fmt::format("slab at {}°", degrees),
                                          {1.0 - (1.0 - f) / (1.0 + f), (1.0 - f) / (1.0 + f)});
        }
    }
}

TEST_F(KernelScatter, DispersionKeepsOneSlotAndItsIndex) {
    const std::array<float, 3> eta{1.5F, 1.6F, 1.7F};
    const Vec3 normal{0.0, 0.0, 1.0};
    const Vec3 direction{0.8, 0.0, -0.6};
    const std::array<double, 3> spectrum{2.0, 3.0, 5.0}; // as the kernel starts paths with
    for (int slot = 0; slot < 3; ++slot) {
        // A path that holds every wavelength chooses `slot`; one that has chosen keeps its own.
        for (const int old_slot : {SLOT_ALL, 0, 2}) {
            const Scattered result = scatter(eta, true, std::vector<cl_float4>(256, float4_of(direction)), normal,
                                             old_slot, slot, false, 37);
            const int kept = old_slot == SLOT_ALL ? slot : old_slot;
            const auto index = static_cast<std::size_t>(kept);
            const double expected = old_slot == SLOT_ALL ? 3.0 * spectrum[index] : 1.0;
            for (std::size_t i = 0; i < result.directions.size(); ++i) {
                ASSERT_EQ(result.weights[i].s[1], static_cast<float>(kept)) << "old slot " << old_slot;
                ASSERT_NEAR(result.weights[i].s[0], expected, 4.0 * unit_roundoff * expected)
                    << "old slot " << old_slot;
                if (result.directions[i].s[2] < 0.0F) {
                    ASSERT_NEAR(result.directions[i].s[0], 0.8 / eta[index], 16.0 * unit_roundoff) << "slot " << kept;
                }
            }
        }
    }
}

TEST_F(KernelScatter, ConductorMultipliesEveryWavelengthByItsReflectance) {
    const std::array<float, 3> eta{0.2F, 1.0F, 3.0F}, k{3.4F, 2.0F, 0.5F};
    const std::array<double, 3> spectrum{2.0, 3.0, 5.0};
    for (const double z : {-0.9, -0.2, 0.5}) {
        const Vec3 direction{std::sqrt(1.0 - z * z), 0.0, z};
        for (const int old_slot : {SLOT_ALL, 0, 1, 2}) {
            SurfaceMaterial material{};
            material.kind = MATERIAL_CONDUCTOR;
            material.eta = 0;
            material.k = 1;
            const Buffer<cl_float4> scattered = make_buffer<cl_float4>(1), weights = make_buffer<cl_float4>(1);
            run(program_, "conductor", 1, upload(table(eta, k)), upload(std::vector{material}),
                upload(std::vector{float4_of(direction)}), float3_of({0.0, 0.0, 1.0}), old_slot, scattered, weights);
            const cl_float4 out = scattered.read(test_device())[0], weight = weights.read(test_device())[0];
            ASSERT_LT(length(vec3(out) - Vec3{direction[0], 0.0, -z}), 8.0 * unit_roundoff);
            for (std::size_t w = 0; w < 3; ++w) {
                const std::complex<double> n2 = std::complex<double>(eta[w], k[w]) * std::complex<double>(eta[w], k[w]);
                const std::complex<double> q = std::sqrt(n2 - (1.0 - z * z));
                const double cosine = std::abs(z);
                const double f =
                    0.5 * (std::norm((cosine - q) / (cosine + q)) + std::norm((n2 * cosine - q) / (n2 * cosine + q)));
                // KernelOptics.ConductorReflectance derives bounds; these tame values are within 200 units.
                const double tolerance = 200.0 * unit_roundoff * spectrum[w];
                if (old_slot == SLOT_ALL) {
                    EXPECT_NEAR(weight.s[w], spectrum[w] * f, tolerance) << "wavelength " << w << ", cosine " << z;
                } else if (old_slot == static_cast<int>(w)) {
                    EXPECT_NEAR(out.s[3], f, tolerance) << "slot " << w << ", cosine " << z;
                }
            }
        }
    }
}

} // namespace
} // namespace tristim
