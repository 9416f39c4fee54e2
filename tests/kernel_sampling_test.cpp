// The maps of kernels/sampling.h against their densities, and the encoding of normals.

#include "kernel_harness.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <gtest/gtest.h>
#include <numbers>

namespace tristim::sampling_test {
namespace {

using namespace kernel_test;
using std::numbers::pi;

const char* const sampling_source = R"(
#include "config.h"
#include "sampling.h"
kernel void disc(const global float2* u, global float4* out) {
    const size_t i = get_global_id(0);
    out[i] = (float4)(sample_disc(u[i]), 0.0f, 0.0f);
}
kernel void cosine_hemisphere(const global float2* u, global float4* out) {
    const size_t i = get_global_id(0);
    out[i] = (float4)(sample_cosine_hemisphere(u[i]), 0.0f);
}
kernel void sphere(const global float2* u, global float4* out) {
    const size_t i = get_global_id(0);
    out[i] = (float4)(sample_sphere(u[i]), 0.0f);
}
kernel void turned(const global float2* u, global float4* out) {
    const size_t i = get_global_id(0);
    out[i] = (float4)(cos_sin_turns(u[i].x), 0.0f, 0.0f);
}
kernel void at_cosine(const global float2* u, float cosine, global float4* out) {
    const size_t i = get_global_id(0);
    out[i] = (float4)(direction_at_cosine(cosine, u[i].y), 0.0f);
}
kernel void triangle(const global float2* u, global float4* out) {
    const size_t i = get_global_id(0);
    out[i] = (float4)(sample_triangle(u[i]), 0.0f, 0.0f);
}
kernel void spot_cosine(const global float2* u, float cos_total_width, float cos_falloff_start, global float4* out) {
    const size_t i = get_global_id(0);
    out[i] = (float4)(sample_spot_cosine(u[i].x, cos_total_width, cos_falloff_start), 0.0f, 0.0f, 0.0f);
}
kernel void spot_terms(const global float2* cosines, const global float2* cones, global float2* out) {
    const size_t i = get_global_id(0);
    out[i] = (float2)(spot_falloff(cosines[i].x, cones[i].x, cones[i].y), spot_solid_angle(cones[i].x, cones[i].y));
}
kernel void frames(const global float4* normals, global float4* out) {
    const size_t i = get_global_id(0);
    const Frame frame = make_frame(normals[i].xyz);
    out[3 * i] = (float4)(frame.s, 0.0f);
    out[3 * i + 1] = (float4)(frame.t, 0.0f);
    out[3 * i + 2] = (float4)(frame_to_world(&frame, (float3)(0.25f, -0.5f, 2.0f)), 0.0f);
}
kernel void pack_and_unpack(const global float4* normals, global float4* out) {
    const size_t i = get_global_id(0);
    out[i] = (float4)(unpack_normal(pack_normal(normals[i].xyz)), 0.0f);
}
)";

constexpr std::size_t samples = 1 << 18;

template <typename... Arguments>
std::vector<cl_float4> sample(const char* kernel, const std::vector<cl_float2>& u, const Arguments&... arguments) {
    const Buffer<cl_float4> output = make_buffer<cl_float4>(u.size());
    run(build_test_program(sampling_source), kernel, u.size(), upload(u), arguments..., output);
    return output.read(test_device());
}

constexpr std::size_t turns = 16;

TEST(KernelSampling, DiscIsUniform) {
    constexpr std::size_t rings = 32;
    Histogram histogram(rings * turns);
    for (const cl_float4& p : sample("disc", random_squares(samples, 10))) {
        const double squared = double{p.s[0]} * p.s[0] + double{p.s[1]} * p.s[1];
        ASSERT_LE(squared, 1.0 + 16.0 * unit_roundoff);
        histogram.add(Histogram::bin(squared, rings) * turns + Histogram::bin(turn(p.s[0], p.s[1]), turns));
    }
    histogram.expect_uniform("disc: rings of equal area, sectors"); // dA = ½ d(r²) dφ
}

TEST(KernelSampling, CosineHemisphereFollowsTheCosine) {
    constexpr std::size_t rings = 32;
    Histogram histogram(rings * turns);
    for (const cl_float4& p : sample("cosine_hemisphere", random_squares(samples, 11))) {
        ASSERT_NEAR(length(vec3(p)), 1.0, 8.0 * unit_roundoff);
        ASSERT_GE(p.s[2], 0.0F);
        histogram.add(Histogram::bin(p.s[2], rings) * turns + Histogram::bin(turn(p.s[0], p.s[1]), turns));
    }
    std::vector<double> expected;
    for (std::size_t bin = 0; bin < rings * turns; ++bin) {
        const double low = static_cast<double>(bin / turns) / rings;
        expected.push_back((low + 1.0 / rings) * (low + 1.0 / rings) - low * low); // ∫ 2z dz
    }
    histogram.expect_distribution("cosine hemisphere: cosine, turn", expected);
}

TEST(KernelSampling, SphereIsUniform) {
    constexpr std::size_t rings = 32;
    Histogram histogram(rings * turns);
    for (const cl_float4& p : sample("sphere", random_squares(samples, 12))) {
        ASSERT_NEAR(length(vec3(p)), 1.0, 8.0 * unit_roundoff);
        histogram.add(Histogram::bin(0.5 * (1.0 + p.s[2]), rings) * turns +
                      Histogram::bin(turn(p.s[0], p.s[1]), turns));
    }
    histogram.expect_uniform("sphere: height, turn");
}

TEST(KernelSampling, CosineAndSineOfTurns) {
    std::vector<cl_float2> u = random_squares(samples, 18);
    for (int eighth = 0; eighth <= 8; ++eighth) {
        for (const float step : {-1e-7F, 0.0F, 1e-7F})
            u.push_back({{std::clamp(static_cast<float>(eighth) / 8.0F + step, 0.0F, 1.0F), 0.0F}});
    }
    const std::vector<cl_float4> results = sample("turned", u);
    for (std::size_t i = 0; i < u.size(); ++i) {
        const double angle = 2.0 * pi * double{u[i].s[0]};
        // The documented 3e-8 of the series and four roundings of values up to 1.
        constexpr double tolerance = 3e-8 + 4.0 * unit_roundoff;
        ASSERT_NEAR(results[i].s[0], std::cos(angle), tolerance) << "cosine of " << u[i].s[0] << " turns";
        ASSERT_NEAR(results[i].s[1], std::sin(angle), tolerance) << "sine of " << u[i].s[0] << " turns";
    }
}

TEST(KernelSampling, DirectionAtCosineKeepsItAndTurnsUniformly) {
    for (const float cosine : {-1.0F, -0.3F, 0.0F, 0.5F, 0.99F}) {
        Histogram histogram(64);
        for (const cl_float4& p : sample("at_cosine", random_squares(1 << 14, 13), cosine)) {
            ASSERT_EQ(p.s[2], cosine);
            // sin² = 1 - cos² has the absolute error of its rounding, 2 units, whatever its size.
            ASSERT_NEAR(dot(vec3(p), vec3(p)), 1.0, 8.0 * unit_roundoff) << "cosine " << cosine;
            histogram.add(Histogram::bin(turn(p.s[0], p.s[1]), 64));
        }
        if (cosine > -1.0F)
            histogram.expect_uniform(fmt::format("turn about the axis at cosine {}", cosine));
    }
}

TEST(KernelSampling, TriangleIsUniform) {
    constexpr std::size_t side = 24;
    Histogram histogram(side * side);
    for (const cl_float4& p : sample("triangle", random_squares(samples, 14))) {
        ASSERT_GE(p.s[0], 0.0F);
        ASSERT_GE(p.s[1], 0.0F);
        ASSERT_LE(double{p.s[0]} + p.s[1], 1.0 + 2.0 * unit_roundoff);
        // db1 db2 = ½ ds dt with s = b1/(1-b2), t = (1-b2)².
        const double rest = 1.0 - p.s[1];
        histogram.add(Histogram::bin(rest > 0.0 ? p.s[0] / rest : 0.0, side) * side +
                      Histogram::bin(rest * rest, side));
    }
    histogram.expect_uniform("triangle: fraction of a row, area above it");
}

/// pbrt-v4's spot light: smoothstep of the cosine.
double smoothstep_falloff(double cosine, double cos_total_width, double cos_falloff_start) {
    if (cosine >= cos_falloff_start)
        return 1.0;
    if (cosine <= cos_total_width)
        return 0.0;
    const double x = (cosine - cos_total_width) / (cos_falloff_start - cos_total_width);
    return (3.0 - 2.0 * x) * x * x;
}

/// Midpoint rule, exact to 1e-7 of the whole for the smooth pieces that the bins are made of.
double integrate(const std::function<double(double)>& f, double low, double high) {
    constexpr int steps = 64;
    double sum = 0.0;
    for (int i = 0; i < steps; ++i)
        sum += f(low + (high - low) * (i + 0.5) / steps);
    return sum * (high - low) / steps;
}

/// Total width and start of the falloff in degrees.
constexpr std::array<std::array<double, 2>, 7> cones{
    {{30.0, 25.0}, {30.0, 30.0}, {30.0, 0.0}, {90.0, 10.0}, {10.0, 9.9}, {170.0, 120.0}, {5.0, 2.0}}};

TEST(KernelSampling, SpotCosineFollowsTheFalloff) {
    constexpr std::size_t bins = 100;
    for (const auto& [total, start] : cones) {
        const auto cos_total = static_cast<float>(std::cos(total * pi / 180.0));
        const auto cos_start = static_cast<float>(std::cos(start * pi / 180.0));
        const auto falloff = [&](double cosine) { return smoothstep_falloff(cosine, cos_total, cos_start); };
        // Bins from the total width to 1, one edge of them at the falloff's start.
        const double whole = 1.0 - cos_total;
        const auto outer = static_cast<std::size_t>(std::ceil(bins * (double{cos_start} - cos_total) / whole));
        const auto edge = [&](std::size_t i) {
            return i <= outer && outer > 0 ? cos_total + (double{cos_start} - cos_total) * static_cast<double>(i) /
                                                             static_cast<double>(outer)
                                           : cos_start + (1.0 - cos_start) * static_cast<double>(i - outer) /
                                                             static_cast<double>(bins - outer);
        };
        std::vector<double> edges, expected;
        for (std::size_t i = 0; i < bins; ++i) {
            edges.push_back(edge(i + 1));
            expected.push_back(integrate(falloff, edge(i), edge(i + 1)));
        }
        Histogram histogram(bins);
        for (const cl_float4& p : sample("spot_cosine", random_squares(samples, 15), cos_total, cos_start)) {
            ASSERT_GE(p.s[0], cos_total);
            ASSERT_LE(p.s[0], 1.0F);
            const auto bin =
                static_cast<std::size_t>(std::lower_bound(edges.begin(), edges.end(), p.s[0]) - edges.begin());
            histogram.add(std::min(bin, bins - 1));
        }
        histogram.expect_distribution(fmt::format("spot cosine, cone of {}° with falloff from {}°", total, start),
                                      expected);
    }
}

/// The cosine's cumulative distribution, in closed form, gives the uniform number back.
TEST(KernelSampling, SpotCosineInvertsItsDistribution) {
    std::vector<cl_float2> u = random_squares(20000, 19);
    for (const float edge : {0.0F, 0x1p-24F, 0.5F, 0x1.fffffep-1F})
        u.push_back({{edge, 0.0F}});
    for (const auto& [total, start] : cones) {
        const auto cos_total = static_cast<float>(std::cos(total * pi / 180.0));
        const auto cos_start = static_cast<float>(std::cos(start * pi / 180.0));
        const std::vector<cl_float4> cosines = sample("spot_cosine", u, cos_total, cos_start);
        const double inner = 1.0 - cos_start, outer = 0.5 * (double{cos_start} - cos_total);
        for (std::size_t i = 0; i < u.size(); ++i) {
            const double cosine = cosines[i].s[0];
            // From 1 down within the cone, then from the total width up in the falloff, whose end is the cone's begin.
            double expected = 1.0 - cosine;
            if (cosine < cos_start || (outer > 0.0 && cosine == cos_start && u[i].s[0] > 0.9F)) {
                const double x = (cosine - cos_total) / (double{cos_start} - cos_total);
                expected = inner + outer * (2.0 * x * x * x - x * x * x * x);
            }
            // The cosine's rounding, two units, weighs at most its own size; the products and the difference before it,
            // eight of the whole.
            ASSERT_NEAR(u[i].s[0] * (inner + outer), expected,
                        4.0 * unit_roundoff + 8.0 * unit_roundoff * (inner + outer))
                << "u = " << u[i].s[0] << ", cone of " << total << "°, falloff from " << start << "°";
        }
    }
}

TEST(KernelSampling, SpotFalloffAndItsIntegral) {
    Random random(16);
    std::vector<cl_float2> cosines, limits;
    for (const auto& [total, start] : cones) {
        const auto cos_total = static_cast<float>(std::cos(total * pi / 180.0));
        const auto cos_start = static_cast<float>(std::cos(start * pi / 180.0));
        for (int i = 0; i < 1000; ++i) {
            cosines.push_back({{static_cast<float>(random(2.0 * cos_total - 1.0, 1.0)), 0.0F}});
            limits.push_back({{cos_total, cos_start}});
        }
    }
    const Buffer<cl_float2> output = make_buffer<cl_float2>(cosines.size());
    run(build_test_program(sampling_source), "spot_terms", cosines.size(), upload(cosines), upload(limits), output);
    const std::vector<cl_float2> terms = output.read(test_device());
    for (std::size_t i = 0; i < terms.size(); ++i) {
        const double cosine = cosines[i].s[0], total = limits[i].s[0], start = limits[i].s[1];
        // The two differences of floats are rounded once each (units of their own size), x by the division; the
        // smoothstep's slope is at most 1.5 and its own evaluation costs 5 roundings of values up to 3.
        EXPECT_NEAR(terms[i].s[0], smoothstep_falloff(cosine, total, start), 24.0 * unit_roundoff)
            << "cosine " << cosine << " between " << total << " and " << start;
        const auto falloff = [&](double c) { return smoothstep_falloff(c, total, start); };
        const double integral = 2.0 * pi * (integrate(falloff, total, start) + (1.0 - start));
        // Midpoint rule with 64 steps: h²/24 · f' at the ends, which is zero, so the error is of order h⁴.
        EXPECT_NEAR(terms[i].s[1], integral, integral * (8.0 * unit_roundoff + 1e-6))
            << "cone " << total << ", " << start;
    }
}

/// Unit vectors all over the sphere: random ones, the axes, planes' edges and near-axis ones, rounded to float.
std::vector<cl_float4> unit_vectors(std::size_t count) {
    Random random(17);
    std::vector<cl_float4> vectors;
    const auto add = [&vectors](const Vec3& v) {
        const Vec3 n = normalized(v);
        vectors.push_back({{static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2]), 0.0F}});
    };
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z)
                if (x != 0 || y != 0 || z != 0)
                    for (const double tiny : {0.0, 1e-3, -1e-6, 1e-20})
                        add({x + tiny, y - tiny, z + 2.0 * tiny});
    while (vectors.size() < count)
        add(random.direction());
    return vectors;
}

TEST(KernelSampling, FramesAreOrthonormalAndRightHanded) {
    const std::vector<cl_float4> normals = unit_vectors(20000);
    const Buffer<cl_float4> output = make_buffer<cl_float4>(3 * normals.size());
    run(build_test_program(sampling_source), "frames", normals.size(), upload(normals), output);
    const std::vector<cl_float4> frames = output.read(test_device());
    // Duff et al. 2017 report errors of a few units for float; products of entries up to 1, three or four roundings
    // each.
    constexpr double tolerance = 12.0 * unit_roundoff;
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const Vec3 n = vec3(normals[i]), s = vec3(frames[3 * i]), t = vec3(frames[3 * i + 1]);
        const std::string at = fmt::format("n = ({}, {}, {})", n[0], n[1], n[2]);
        ASSERT_NEAR(length(s), 1.0, tolerance) << at;
        ASSERT_NEAR(length(t), 1.0, tolerance) << at;
        ASSERT_NEAR(dot(s, t), 0.0, tolerance) << at;
        ASSERT_NEAR(dot(s, n), 0.0, tolerance) << at;
        ASSERT_NEAR(dot(t, n), 0.0, tolerance) << at;
        ASSERT_NEAR(dot(cross(s, t), n), 1.0, 2.0 * tolerance) << at;
        const Vec3 world = 0.25 * s + -0.5 * t + 2.0 * n;
        ASSERT_NEAR(length(world - vec3(frames[3 * i + 2])), 0.0, 16.0 * unit_roundoff) << at;
    }
}

TEST(KernelSampling, PackedNormalsKeepTheirDirection) {
    const std::vector<cl_float4> normals = unit_vectors(1 << 18);
    const Buffer<cl_float4> output = make_buffer<cl_float4>(normals.size());
    run(build_test_program(sampling_source), "pack_and_unpack", normals.size(), upload(normals), output);
    const std::vector<cl_float4> unpacked = output.read(test_device());
    // Each coordinate of the octahedron is off by half a step, 0.5/32767, so the point on it by at most √2·√3/2 times
    // that times √2 (its third coordinate follows the sum of both); the octahedron's faces are 1/√3 from the centre,
    // which magnifies to √3 times that as an angle: below 6.5e-5 rad. The documented bound is 0.04°, ten times as much.
    constexpr double bound = 6.5e-5;
    static_assert(bound < 0.04 * pi / 180.0);
    double worst = 0.0;
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const double angle = std::asin(std::min(length(cross(vec3(normals[i]), vec3(unpacked[i]))), 1.0));
        worst = std::max(worst, angle);
        ASSERT_GT(dot(vec3(normals[i]), vec3(unpacked[i])), 0.0);
        ASSERT_LT(angle, bound) << "normal (" << normals[i].s[0] << ", " << normals[i].s[1] << ", " << normals[i].s[2]
                                << ")";
    }
    RecordProperty("worst_angle_rad", fmt::format("{}", worst));
    EXPECT_GT(worst, 0.1 * bound) << "the test did not look closely";
}

} // namespace
} // namespace tristim::sampling_test
