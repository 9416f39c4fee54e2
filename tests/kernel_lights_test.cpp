// Emission of photons and direct light: kernels/lights.h, against densities and closed forms.

#include "kernel_harness.h"
#include "shared_types.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>

namespace tristim {
namespace {

using namespace kernel_test;
using std::numbers::pi;

const char* const lights_source = R"(
#include "lights.h"
kernel void choose(const global SceneConstants* constants, const global float* light_cdf, const global float* u,
                   global int* chosen) {
    Scene scene;
    scene.constants = constants;
    scene.light_cdf = light_cdf;
    chosen[get_global_id(0)] = choose_light(&scene, u[get_global_id(0)]);
}
kernel void emit(const global SceneConstants* constants, const global SceneLight* light, const global float4* u,
                 global float4* origins, global float4* directions) {
    const size_t i = get_global_id(0);
    Scene scene;
    scene.constants = constants;
    const Emission e = sample_emission(&scene, light, u[i].xy, u[i].zw);
    origins[i] = (float4)(e.origin, e.power);
    directions[i] = (float4)(e.direction, 0.0f);
}
// Each point twice: the plain one and its normal.
kernel void direct(const global SceneLight* light, const global float4* points, const global float2* u,
                   global float4* origins, global float4* directions) {
    const size_t i = get_global_id(0);
    Interaction it;
    it.point = points[2 * i].xyz;
    it.normal = points[2 * i + 1].xyz;
    it.shading_normal = it.normal;
    it.extent = 8.0f;
    it.material = 0;
    it.light = -1;
    const DirectLight d = sample_direct(light, &it, it.normal, false, u[i]);
    origins[i] = (float4)(d.origin, d.irradiance);
    directions[i] = (float4)(d.direction, d.t_max);
}
)";

const Macros macros{{"HAS_POINT_LIGHT", "1"},
                    {"HAS_SPOT_LIGHT", "1"},
                    {"HAS_DISTANT_LIGHT", "1"},
                    {"HAS_INFINITE_LIGHT", "1"},
                    {"HAS_AREA_LIGHT", "1"}};

constexpr std::size_t samples = 1 << 18;

void store(const Vec3& v, float& x, float& y, float& z) {
    x = static_cast<float>(v[0]);
    y = static_cast<float>(v[1]);
    z = static_cast<float>(v[2]);
}

const Vec3 position{1.0, -2.0, 0.5};
const Vec3 axis = normalized({0.3, -0.9, 0.4});
const Vec3 centre{0.25, 1.0, -3.0};
constexpr double scene_radius = 4.0;
constexpr float scale = 2.5F;
constexpr float probability = 0.3F;

SceneConstants constants() {
    SceneConstants c{};
    store(centre, c.centre_x, c.centre_y, c.centre_z);
    c.radius = scene_radius;
    c.light_count = 1;
    return c;
}

SceneLight make_light(int kind) {
    SceneLight light{};
    light.kind = kind;
    light.scale = scale;
    light.probability = probability;
    store(position, light.position_x, light.position_y, light.position_z);
    store(axis, light.direction_x, light.direction_y, light.direction_z);
    return light;
}

const Vec3 edge1 = 2.0 * tangents(axis)[0];
const Vec3 edge2 = 0.5 * tangents(axis)[0] + 1.5 * tangents(axis)[1];

SceneLight area_light(bool two_sided) {
    SceneLight light = make_light(LIGHT_AREA);
    store(edge1, light.edge1_x, light.edge1_y, light.edge1_z);
    store(edge2, light.edge2_x, light.edge2_y, light.edge2_z);
    light.area = static_cast<float>(0.5 * length(cross(edge1, edge2)));
    light.two_sided = two_sided ? 1 : 0;
    light.extent = 4.0F;
    return light;
}

struct Emitted {
    std::vector<cl_float4> origins, directions;
};

Emitted emit(const SceneLight& light) {
    const Buffer<cl_float4> origins = make_buffer<cl_float4>(samples), directions = make_buffer<cl_float4>(samples);
    run(build_test_program(lights_source, macros), "emit", samples, upload(std::vector{constants()}),
        upload(std::vector{light}), upload(random_hypercubes(samples, 20)), origins, directions);
    return {origins.read(test_device()), directions.read(test_device())};
}

/// Every photon carries the same power: the light's over the chance that it was chosen.
void expect_power(const Emitted& emitted, double power) {
    const double expected = power * scale / double{probability};
    for (const cl_float4& origin : emitted.origins)
        ASSERT_NEAR(origin.s[3], expected, expected * 16.0 * unit_roundoff);
}

/// Cosine to an axis and the turn about it.
std::array<double, 2> about(const Vec3& direction, const Vec3& n) {
    const auto [s, t] = tangents(n);
    return {dot(direction, n), turn(dot(direction, s), dot(direction, t))};
}

TEST(KernelLights, LightsAreChosenByPower) {
    const std::vector<float> powers{0.0F, 1.0F, 0.0F, 3.0F, 0.5F, 5.5F, 0.0F};
    std::vector<float> cdf{0.0F};
    for (const float power : powers)
        cdf.push_back(cdf.back() + power / 10.0F);
    cdf.back() = 1.0F;
    cdf[cdf.size() - 2] = 1.0F;
    SceneConstants c = constants();
    c.light_count = static_cast<int>(powers.size());
    Random random(21);
    std::vector<float> u{0.0F, 0x1.fffffep-1F, 0.1F};
    while (u.size() < samples)
        u.push_back(random());
    const Buffer<int> output = make_buffer<int>(samples);
    run(build_test_program(lights_source, macros), "choose", samples, upload(std::vector{c}), upload(cdf), upload(u),
        output);
    const std::vector<int> chosen = output.read(test_device());
    EXPECT_EQ(chosen[0], 1) << "u = 0";
    EXPECT_EQ(chosen[1], 5) << "u just below 1";
    EXPECT_EQ(chosen[2], 3) << "u on an interval's lower end, past a light without power";
    Histogram histogram(powers.size());
    for (const int light : chosen)
        histogram.add(static_cast<std::size_t>(light));
    histogram.expect_distribution("choice of light", {powers.begin(), powers.end()});
}

TEST(KernelLights, PointLightEmitsEverywhere) {
    const Emitted emitted = emit(make_light(LIGHT_POINT));
    expect_power(emitted, 4.0 * pi);
    Histogram histogram(16 * 16);
    for (std::size_t i = 0; i < samples; ++i) {
        ASSERT_EQ(vec3(emitted.origins[i]), position);
        const auto [cosine, angle] = about(vec3(emitted.directions[i]), axis);
        histogram.add(Histogram::bin(0.5 + 0.5 * cosine, 16) * 16 + Histogram::bin(angle, 16));
    }
    histogram.expect_uniform("point light: cosine, turn");
}

TEST(KernelLights, SpotLightFollowsItsFalloff) {
    constexpr std::size_t rings = 20, turns = 12;
    // Total width and start of the falloff in degrees; equal: no falloff at all.
    for (const auto& [total, start] : {std::array{40.0, 30.0}, {25.0, 25.0}, {60.0, 0.0}, {120.0, 80.0}, {6.0, 5.0}}) {
        SceneLight light = make_light(LIGHT_SPOT);
        light.cos_total_width = static_cast<float>(std::cos(total * pi / 180.0));
        light.cos_falloff_start = static_cast<float>(std::cos(start * pi / 180.0));
        const double low = light.cos_total_width;
        const double width = double{light.cos_falloff_start} - low;
        const auto falloff = [&](double cosine) {
            const double x = width > 0.0 ? std::clamp((cosine - low) / width, 0.0, 1.0) : 1.0;
            return x * x * (3.0 - 2.0 * x);
        };
        std::vector<double> expected;
        double integral = 0.0;
        for (std::size_t ring = 0; ring < rings; ++ring) {
            constexpr int steps = 2000; // midpoints; a kink inside a bin costs less than 1e-6 of it
            double sum = 0.0;
            for (int i = 0; i < steps; ++i)
                sum += falloff(low + (1.0 - low) * (static_cast<double>(ring) + (i + 0.5) / steps) / rings) / steps;
            integral += 2.0 * pi * sum * (1.0 - low) / rings;
            expected.insert(expected.end(), turns, sum);
        }
        const Emitted emitted = emit(light);
        // The power comes from 1 - cosine, a difference of floats.
        const double power = emitted.origins[0].s[3] * double{probability} / scale;
        EXPECT_NEAR(power, integral, integral * 1e-5) << "cone of " << total << "°, falloff from " << start << "°";
        Histogram histogram(rings * turns);
        for (const cl_float4& direction : emitted.directions) {
            const auto [cosine, angle] = about(vec3(direction), axis);
            ASSERT_GE(cosine, low - 8.0 * unit_roundoff);
            histogram.add(Histogram::bin((cosine - low) / (1.0 - low), rings) * turns + Histogram::bin(angle, turns));
        }
        histogram.expect_distribution(fmt::format("spot of {}°, falloff from {}°: cosine, turn", total, start),
                                      expected);
    }
}

/// Position across the direction, in units of the scene's radius, of a ray that enters the bounding sphere's hull.
std::array<double, 2> entry(const cl_float4& origin, const Vec3& direction) {
    const Vec3 from_centre = vec3(origin) - centre;
    EXPECT_NEAR(dot(from_centre, direction), -scene_radius, 1e-5);
    const auto [s, t] = tangents(direction);
    const double x = dot(from_centre, s) / scene_radius, y = dot(from_centre, t) / scene_radius;
    return {x * x + y * y, turn(x, y)};
}

TEST(KernelLights, DistantLightCoversTheScene) {
    const Emitted emitted = emit(make_light(LIGHT_DISTANT));
    expect_power(emitted, pi * scene_radius * scene_radius);
    Histogram histogram(16 * 16);
    const Vec3 direction{static_cast<float>(axis[0]), static_cast<float>(axis[1]), static_cast<float>(axis[2])};
    for (std::size_t i = 0; i < samples; ++i) {
        ASSERT_EQ(vec3(emitted.directions[i]), direction);
        const auto [squared, angle] = entry(emitted.origins[i], axis);
        ASSERT_LE(squared, 1.0 + 1e-5);
        histogram.add(Histogram::bin(squared, 16) * 16 + Histogram::bin(angle, 16));
    }
    histogram.expect_uniform("distant light: rings, sectors of the disc");
}

TEST(KernelLights, InfiniteLightCoversTheSceneFromEverywhere) {
    const Emitted emitted = emit(make_light(LIGHT_INFINITE));
    expect_power(emitted, 4.0 * pi * pi * scene_radius * scene_radius);
    constexpr std::size_t side = 6;
    Histogram histogram(side * side * side * side);
    for (std::size_t i = 0; i < samples; ++i) {
        const Vec3 direction = normalized(vec3(emitted.directions[i]));
        const auto [squared, angle] = entry(emitted.origins[i], direction);
        const auto [cosine, azimuth] = about(direction, axis);
        histogram.add(((Histogram::bin(squared, side) * side + Histogram::bin(angle, side)) * side +
                       Histogram::bin(0.5 + 0.5 * cosine, side)) *
                          side +
                      Histogram::bin(azimuth, side));
    }
    histogram.expect_uniform("infinite light: place on the disc, direction");
}

/// Fractions of a triangle's area, by row and within the row, of a point in its plane.
std::array<double, 2> in_triangle(const Vec3& point) {
    const Vec3 p = point - position;
    const Vec3 n = cross(edge1, edge2);
    const double b1 = dot(cross(p, edge2), n) / dot(n, n);
    const double b2 = dot(cross(edge1, p), n) / dot(n, n);
    EXPECT_GE(b1, -1e-4);
    EXPECT_GE(b2, -1e-4);
    EXPECT_LE(b1 + b2, 1.0 + 1e-4);
    return {b1 / (1.0 - b2), (1.0 - b2) * (1.0 - b2)};
}

TEST(KernelLights, AreaLightEmitsByTheCosineFromItsWholeArea) {
    for (const bool two_sided : {false, true}) {
        const SceneLight light = area_light(two_sided);
        const Emitted emitted = emit(light);
        expect_power(emitted, pi * light.area * (two_sided ? 2.0 : 1.0));
        constexpr std::size_t side = 5;
        Histogram histogram(2 * side * side * side * side);
        for (std::size_t i = 0; i < samples; ++i) {
            const auto [cosine, azimuth] = about(vec3(emitted.directions[i]), axis);
            const double height = dot(vec3(emitted.origins[i]) - position, axis);
            // Just off the surface, on the side of the direction: no more than 256 units in the last place of
            // coordinates up to 4.
            ASSERT_GT(height * cosine, -1e-6 * std::abs(cosine));
            ASSERT_LT(std::abs(height), 3.0 * 256.0 * 0x1p-22);
            const auto [row, within] = in_triangle(vec3(emitted.origins[i]));
            std::size_t bin = cosine > 0.0 ? 0 : 1;
            bin = bin * side + Histogram::bin(cosine * cosine, side); // cos θ / π dω is uniform in cos² θ
            for (const double fraction : {azimuth, row, within})
                bin = bin * side + Histogram::bin(fraction, side);
            histogram.add(bin);
        }
        std::vector<double> expected(2 * side * side * side * side, 1.0);
        if (!two_sided)
            std::fill(expected.begin() + static_cast<std::ptrdiff_t>(expected.size() / 2), expected.end(), 0.0);
        histogram.expect_distribution(two_sided ? "two-sided area light" : "area light", expected);
    }
}

struct Direct {
    std::vector<cl_float4> points, origins, directions;
    Vec3 point(std::size_t i) const { return vec3(points[2 * i]); }
    Vec3 normal(std::size_t i) const { return vec3(points[2 * i + 1]); }
};

/// Direct light at random points around the light, up to 5 away, with random normals; or all at one point.
Direct sample_direct(const SceneLight& light, std::size_t count, bool one_point) {
    Random random(22);
    Direct result;
    const auto add = [&result](const Vec3& v) {
        result.points.push_back({{static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]), 0.0F}});
    };
    for (std::size_t i = 0; i < count; ++i) {
        add(one_point ? position + 3.0 * axis : position + random(1.0, 5.0) * random.direction());
        add(one_point ? normalized({-0.2, 0.9, -0.5}) : random.direction());
    }
    const Buffer<cl_float4> origins = make_buffer<cl_float4>(count), directions = make_buffer<cl_float4>(count);
    run(build_test_program(lights_source, macros), "direct", count, upload(std::vector{light}), upload(result.points),
        upload(random_squares(count, 23)), origins, directions);
    result.origins = origins.read(test_device());
    result.directions = directions.read(test_device());
    return result;
}

/// Shadow rays of lights at a finite distance end at their target, with the light's inverse square law.
TEST(KernelLights, DirectLightOfPointAndSpot) {
    for (const int kind : {LIGHT_POINT, LIGHT_SPOT}) {
        SceneLight light = make_light(kind);
        light.cos_total_width = -0.5F;
        light.cos_falloff_start = 0.5F;
        const Direct direct = sample_direct(light, 20000, false);
        for (std::size_t i = 0; i < direct.origins.size(); ++i) {
            const Vec3 towards = position - direct.point(i);
            const double distance = length(towards);
            double expected = std::max(dot(towards, direct.normal(i)), 0.0) / std::pow(distance, 3);
            if (kind == LIGHT_SPOT) {
                const double x = std::clamp(0.5 - dot(towards, axis) / distance, 0.0, 1.0);
                expected *= x * x * (3.0 - 2.0 * x);
            }
            expected *= scale / double{probability};
            // Both cosines have absolute errors of a few units (dot products of vectors of length up to 1, the
            // position's rounding up to 4 over distances from 1 on), the rest relative ones.
            const double largest = scale / double{probability} / (distance * distance);
            ASSERT_NEAR(direct.origins[i].s[3], expected, 64.0 * unit_roundoff * largest)
                << (kind == LIGHT_SPOT ? "spot" : "point") << " light at distance " << distance;
            ASSERT_EQ(direct.directions[i].s[3], 1.0F);
            const Vec3 end = vec3(direct.origins[i]) + vec3(direct.directions[i]);
            ASSERT_LT(length(end - position), 1e-5) << "the shadow ray must end at the light";
        }
    }
}

TEST(KernelLights, DirectLightOfDistantLight) {
    const Direct direct = sample_direct(make_light(LIGHT_DISTANT), 20000, false);
    for (std::size_t i = 0; i < direct.origins.size(); ++i) {
        const double expected = std::max(-dot(axis, direct.normal(i)), 0.0) * scale / double{probability};
        ASSERT_NEAR(direct.origins[i].s[3], expected, 32.0 * unit_roundoff * scale / probability);
        ASSERT_LT(length(vec3(direct.directions[i]) + axis), 1e-6);
        ASSERT_GT(direct.directions[i].s[3], 1e20F);
    }
}

TEST(KernelLights, DirectLightOfInfiniteLightFollowsTheCosine) {
    const Direct direct = sample_direct(make_light(LIGHT_INFINITE), samples, true);
    Histogram histogram(16 * 16);
    for (std::size_t i = 0; i < direct.origins.size(); ++i) {
        const double expected = pi * scale / double{probability};
        ASSERT_NEAR(direct.origins[i].s[3], expected, 8.0 * unit_roundoff * expected);
        ASSERT_GT(direct.directions[i].s[3], 1e20F);
        const auto [cosine, angle] = about(vec3(direct.directions[i]), direct.normal(i));
        ASSERT_GT(cosine, -1e-6);
        histogram.add(Histogram::bin(cosine * cosine, 16) * 16 + Histogram::bin(angle, 16));
    }
    histogram.expect_uniform("direct light of an infinite light: squared cosine, turn");
}

TEST(KernelLights, DirectLightOfAreaLightIsUniformOverItsArea) {
    for (const bool two_sided : {false, true}) {
        const SceneLight light = area_light(two_sided);
        Histogram histogram(16 * 16);
        const Direct from_one_point = sample_direct(light, samples, true);
        for (std::size_t i = 0; i < samples; ++i) {
            const auto [row, within] =
                in_triangle(vec3(from_one_point.origins[i]) + vec3(from_one_point.directions[i]));
            histogram.add(Histogram::bin(row, 16) * 16 + Histogram::bin(within, 16));
        }
        histogram.expect_uniform("direct light of an area light: place on the triangle");

        // L cos θ cos θ' A / d² for the point where the shadow ray ends, which lies off the light by up to 1e-3.
        const Direct direct = sample_direct(light, 20000, false);
        for (std::size_t i = 0; i < direct.origins.size(); ++i) {
            const Vec3 target = vec3(direct.origins[i]) + vec3(direct.directions[i]);
            const Vec3 towards = target - direct.point(i);
            const double distance = length(towards);
            const double at_light = -dot(towards, axis) / distance;
            const double expected = scale / double{probability} * light.area *
                                    std::max(dot(towards, direct.normal(i)), 0.0) / distance *
                                    (two_sided ? std::abs(at_light) : std::max(at_light, 0.0)) / (distance * distance);
            const double offset = 1e-3 / distance;
            ASSERT_NEAR(direct.origins[i].s[3], expected,
                        scale / double{probability} * light.area / (distance * distance) * 4.0 * offset)
                << "distance " << distance << ", cosine at the light " << at_light;
        }
    }
}

} // namespace
} // namespace tristim
