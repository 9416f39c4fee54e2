// kernels/texture.h against pbrt-v4's definitions of textures and mappings in double precision.

#include "kernel_harness.h"

#include "render/flat_texture.h"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <numbers>

namespace tristim {
namespace {

using namespace kernel_test;
using std::numbers::pi;
using Wrap = Texture::Wrap;
using Mapping = Texture::Mapping;

const char* const texture_source = R"(
#include "texture.h"
kernel void evaluate(const global SceneTexture* texture, const global float* texels, const global float4* points,
                     const global float2* uv, global float* out) {
    const size_t i = get_global_id(0);
    out[i] = evaluate_texture(texture, texels, points[i].xyz, uv[i]);
}
)";

/// A texture at points with coordinates uv; the texels lie behind some that belong to another texture.
std::vector<float> evaluate(const Texture& texture, const std::vector<Vec3>& points, const std::vector<cl_float2>& uv) {
    static const ::cl::Program program = build_test_program(texture_source);
    std::vector<float> texels{1e9F, 1e9F, 1e9F};
    const SceneTexture flat = flatten_texture(texture, V3d(0.0), texels);
    std::vector<cl_float4> positions;
    for (const Vec3& p : points)
        positions.push_back({{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]), 0.0F}});
    const auto texture_buffer = upload(std::vector<SceneTexture>{flat});
    const auto texel_buffer = upload(texels);
    const auto point_buffer = upload(positions);
    const auto uv_buffer = upload(uv);
    auto out = make_buffer<float>(points.size());
    run(program, "evaluate", points.size(), texture_buffer, texel_buffer, point_buffer, uv_buffer, out);
    return out.read(test_device());
}

std::vector<float> evaluate(const Texture& texture, const std::vector<cl_float2>& uv) {
    return evaluate(texture, std::vector<Vec3>(uv.size(), Vec3{}), uv);
}

std::vector<float> evaluate(const Texture& texture, const std::vector<Vec3>& points) {
    return evaluate(texture, points, std::vector<cl_float2>(points.size(), {{0.0F, 0.0F}}));
}

/// pbrt's RemapPixelCoords, Image::GetChannel and BilerpChannel at (s, 1 - t).
double image_oracle(const Texture& texture, double s, double t) {
    const auto texel = [&](long x, long y) {
        std::array<long, 2> p{x, y};
        const std::array<long, 2> size{texture.width, texture.height};
        for (std::size_t i = 0; i < 2; ++i) {
            if (p[i] >= 0 && p[i] < size[i])
                continue;
            if (texture.wrap == Wrap::Black)
                return texture.outside;
            p[i] = texture.wrap == Wrap::Clamp ? std::clamp(p[i], 0L, size[i] - 1)
                                               : ((p[i] % size[i]) + size[i]) % size[i];
        }
        return double{texture.texels[static_cast<std::size_t>(p[1] * size[0] + p[0])]};
    };
    const double x = s * texture.width - 0.5, y = (1.0 - t) * texture.height - 0.5;
    const double fx = x - std::floor(x), fy = y - std::floor(y);
    const long xi = std::lround(std::floor(x)), yi = std::lround(std::floor(y));
    return (1.0 - fx) * (1.0 - fy) * texel(xi, yi) + fx * (1.0 - fy) * texel(xi + 1, yi) +
           (1.0 - fx) * fy * texel(xi, yi + 1) + fx * fy * texel(xi + 1, yi + 1);
}

/// A picture of random texels in [0, 1].
Texture picture(int width, int height, Wrap wrap) {
    Texture texture;
    texture.kind = Texture::Kind::Image;
    texture.wrap = wrap;
    texture.width = width;
    texture.height = height;
    Random random(5);
    for (int i = 0; i < width * height; ++i)
        texture.texels.push_back(random());
    texture.outside = 0.75;
    return texture;
}

Texture bilinear(Mapping mapping) {
    Texture texture;
    texture.mapping = mapping;
    texture.corners = {300.0, 500.0, 700.0, 200.0};
    return texture;
}

double bilinear_oracle(const Texture& texture, double s, double t) {
    const auto& [v00, v01, v10, v11] = texture.corners;
    return (1.0 - s) * (1.0 - t) * v00 + s * (1.0 - t) * v10 + (1.0 - s) * t * v01 + s * t * v11;
}

class KernelTextureWrap : public testing::TestWithParam<Wrap> {};

TEST_P(KernelTextureWrap, ImageIsPbrtsBilinearLookup) {
    const Texture texture = picture(7, 5, GetParam());
    std::vector<cl_float2> uv;
    Random random(1);
    for (int i = 0; i < 4000; ++i)
        uv.push_back({{static_cast<float>(random(-2.5, 3.5)), static_cast<float>(random(-2.5, 3.5))}});
    // Texels' centres and borders, and the picture's edges.
    for (int i = -14; i <= 28; ++i)
        for (int j = -10; j <= 20; ++j)
            uv.push_back({{static_cast<float>(i) / 14.0F, static_cast<float>(j) / 10.0F}});
    const std::vector<float> values = evaluate(texture, uv);
    // Coordinates of up to 4 times 7 texels are rounded a few times, and a step of one texel changes the value by at
    // most 1 along each axis; the weights' products round some more.
    const double tolerance = 8.0 * 28.0 * unit_roundoff;
    for (std::size_t i = 0; i < uv.size(); ++i)
        ASSERT_NEAR(values[i], image_oracle(texture, uv[i].s[0], uv[i].s[1]), tolerance)
            << "at " << uv[i].s[0] << ", " << uv[i].s[1];
}

INSTANTIATE_TEST_SUITE_P(, KernelTextureWrap, testing::Values(Wrap::Repeat, Wrap::Clamp, Wrap::Black),
                         [](const auto& wrap) {
                             return wrap.param == Wrap::Repeat  ? "Repeat"
                                    : wrap.param == Wrap::Clamp ? "Clamp"
                                                                : "Black";
                         });

TEST(KernelTexture, ImageStaysInItsTexelsForAnyCoordinates) {
    std::vector<cl_float2> uv;
    for (const float u : {1e9F, -1e9F, 3e38F, -3e38F, INFINITY, -INFINITY, NAN, 0.5F})
        for (const float v : {1e9F, -1e9F, 3e38F, -3e38F, INFINITY, -INFINITY, NAN, 0.5F})
            uv.push_back({{u, v}});
    for (const Wrap wrap : {Wrap::Repeat, Wrap::Clamp, Wrap::Black}) {
        for (const float value : evaluate(picture(7, 5, wrap), uv)) {
            EXPECT_GE(value, 0.0F);
            EXPECT_LE(value, 1.0F);
        }
    }
}

TEST(KernelTexture, OneTexelIsTheSameEverywhere) {
    const Texture texture = picture(1, 1, Wrap::Repeat);
    for (const float value : evaluate(texture, random_squares(100, 3)))
        EXPECT_NEAR(value, texture.texels[0], unit_roundoff);
}

TEST(KernelTexture, UvMappingScalesAndShifts) {
    Texture texture = bilinear(Mapping::Uv);
    texture.uv_scale = {2.0, -0.5, 0.25, 0.75};
    const std::vector<cl_float2> uv = random_squares(1000, 2);
    const std::vector<float> values = evaluate(texture, uv);
    // Some ten roundings of terms that are at most 700 · 2.25 · 0.75.
    const double tolerance = 10.0 * 1200.0 * unit_roundoff;
    for (std::size_t i = 0; i < uv.size(); ++i)
        ASSERT_NEAR(values[i], bilinear_oracle(texture, 2.0 * uv[i].s[0] + 0.25, -0.5 * uv[i].s[1] + 0.75), tolerance);
}

/// Points of the cube [-2, 2]³, as float holds them.
std::vector<Vec3> random_points(std::size_t count) {
    Random random(4);
    std::vector<Vec3> points(count);
    for (Vec3& p : points)
        for (double& x : p)
            x = static_cast<float>(random(-2.0, 2.0));
    return points;
}

/// World to texture space: turned by 90° about x, scaled by 1/2, and moved: (x, y, z) to (x/2 + 1/4, z/2, -y/2 - 1).
M44d to_texture_space() {
    return {0.5,  0.0, 0.0,  0.0, //
            0.0,  0.0, -0.5, 0.0, //
            0.0,  0.5, 0.0,  0.0, //
            0.25, 0.0, -1.0, 1.0};
}
Vec3 in_texture_space(const Vec3& p) {
    return {0.5 * p[0] + 0.25, 0.5 * p[2], -0.5 * p[1] - 1.0};
}

TEST(KernelTexture, PlanarMappingTakesXAndY) {
    Texture texture = bilinear(Mapping::Planar);
    texture.world_to_texture = to_texture_space();
    const std::vector<Vec3> points = random_points(1000);
    const std::vector<float> values = evaluate(texture, points);
    const double tolerance = 10.0 * 700.0 * 1.25 * unit_roundoff; // roundings of terms up to 700 · 1.25
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3 p = in_texture_space(points[i]);
        ASSERT_NEAR(values[i], bilinear_oracle(texture, p[0], p[1]), tolerance);
    }
}

// The angular mappings: a coordinate may be off by some units of roundoff (atan2pi: 6 ulp by the OpenCL standard, and
// the point's own rounding divided by its distance from the axis, at least 0.01 in a cube of 2), which the corners'
// differences of up to 500 amplify.
constexpr double angular_tolerance = 500.0 * (16.0 + 4.0 * 2.0 / 0.01) * unit_roundoff;

/// Compares an angular mapping with coordinates(p), p in texture space, but at the axis and at the seam, the half plane
/// towards ±x, where the function jumps.
void expect_angular(Mapping mapping, double seam_x, double tolerance,
                    const std::function<std::array<double, 2>(const Vec3&)>& coordinates) {
    Texture texture = bilinear(mapping);
    texture.world_to_texture = to_texture_space();
    const std::vector<Vec3> points = random_points(4000);
    const std::vector<float> values = evaluate(texture, points);
    std::size_t checked = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3 p = in_texture_space(points[i]);
        if (std::hypot(p[0], p[1]) < 0.01 || (seam_x * p[0] > 0.0 && std::abs(p[1]) < 1e-5))
            continue;
        ++checked;
        const auto [s, t] = coordinates(p);
        ASSERT_NEAR(values[i], bilinear_oracle(texture, s, t), tolerance);
    }
    EXPECT_GT(checked, points.size() * 9 / 10);
}

TEST(KernelTexture, SphericalMappingIsPolarAngleAndTurn) {
    expect_angular(Mapping::Spherical, 1.0, angular_tolerance, [](const Vec3& p) {
        return std::array{std::acos(p[2] / length(p)) / pi, turn(p[0], p[1])};
    });
}

TEST(KernelTexture, CylindricalMappingIsTurnAndHeight) {
    // z reaches -2, where the corners' weights are up to 3.
    expect_angular(Mapping::Cylindrical, -1.0, 3.0 * angular_tolerance, [](const Vec3& p) {
        return std::array{(pi + std::atan2(p[1], p[0])) / (2.0 * pi), p[2]};
    });
}

TEST(KernelTexture, AngularMappingsJumpAtTheirSeamsOnly) {
    // v is the turn of the spherical mapping, which begins at +x; u that of the cylindrical one, which begins at -x.
    Texture spherical = bilinear(Mapping::Spherical);
    spherical.corners = {0.0, 1.0, 0.0, 1.0};
    Texture cylindrical = bilinear(Mapping::Cylindrical);
    cylindrical.corners = {0.0, 0.0, 1.0, 1.0};
    const double e = 1e-6;
    const std::vector<Vec3> points{{1, 0, 0}, {1, e, 0}, {0, 1, 0}, {-1, e, 0}, {-1, -e, 0}, {0, -1, 0}, {1, -e, 0}};
    const std::vector<double> turns{0.0, 0.0, 0.25, 0.5, 0.5, 0.75, 1.0};
    const std::vector<double> from_minus_x{0.5, 0.5, 0.75, 1.0, 0.0, 0.25, 0.5};
    const std::vector<float> s = evaluate(spherical, points), c = evaluate(cylindrical, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_NEAR(s[i], turns[i], e) << i;
        EXPECT_NEAR(c[i], from_minus_x[i], e) << i;
    }
}

TEST(KernelTexture, SphericalMappingIsExactNearThePoles) {
    Texture texture = bilinear(Mapping::Spherical);
    texture.corners = {0.0, 0.0, pi, pi}; // the polar angle itself
    const std::vector<float> values = evaluate(texture, std::vector<Vec3>{{0, 0, 2}, {1e-5, 0, 1}, {0, 0, -2}});
    EXPECT_EQ(values[0], 0.0F);
    EXPECT_NEAR(values[1], 1e-5, 1e-5 * 16.0 * unit_roundoff);
    EXPECT_NEAR(values[2], pi, 4.0 * unit_roundoff);
}

} // namespace
} // namespace tristim
