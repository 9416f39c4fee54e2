// kernels/film.cl: sums that survive many passes, samples that are not finite, and the statistics of the radius.

#include "kernel_harness.h"
#include "render/film.h"
#include "shared_types.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace tristim {
namespace {

using namespace kernel_test;

constexpr double alpha = 2.0 / 3.0;

class KernelFilm : public ::testing::Test {
  protected:
    void build(bool statistics) {
        program_ = build_program(test_device(), "film.cl", {{"RADIUS_STATISTICS", statistics ? "1" : "0"}}, {});
    }

    Buffer<FilmPixel> cleared(const std::vector<float>& radii) const {
        const Buffer<FilmPixel> film = make_buffer<FilmPixel>(radii.size());
        run(program_, "film_clear", radii.size(), upload(radii), film);
        return film;
    }

    void add(const std::vector<VisiblePoint>& points, const std::vector<cl_float4>& flux,
             const Buffer<FilmPixel>& film) const {
        run(program_, "film_add", points.size(), upload(points), upload(flux), static_cast<float>(alpha), film);
    }

    ::cl::Program program_;
};

VisiblePoint direct_only(float x, float y, float z) {
    VisiblePoint point{};
    point.slot = SLOT_NONE;
    point.direct_x = x;
    point.direct_y = y;
    point.direct_z = z;
    return point;
}

/// The film's own functions, looped on the device: a million additions to one pixel.
TEST_F(KernelFilm, MillionAdditionsLoseNothing) {
    const ::cl::Program program = build_test_program(R"(
#include "film.cl"
// two: high and low part; three: high, middle and low. Three sums alike.
kernel void add_many(uint count, float even, float odd, global float* two, global float* three) {
    float3 high = 0.0f, low = 0.0f, first = 0.0f, second = 0.0f, third = 0.0f;
    for (uint i = 0; i < count; ++i) {
        add_compensated(&high, &low, (float3)((i & 1u) ? odd : even));
        add_to_sum(&first, &second, &third, (float3)((i & 1u) ? odd : even));
    }
    two[0] = high.x;
    two[1] = low.y;
    three[0] = first.x;
    three[1] = second.y;
    three[2] = third.z;
}
)");
    constexpr std::uint32_t count = 1000000;
    constexpr std::array<std::array<float, 2>, 3> samples{{{0.1F, 0.1F}, {1234.5F, 0.007F}, {1.7e-4F, 3.3e-6F}}};
    for (const auto& [even, odd] : samples) {
        const Buffer<float> two = upload(std::vector<float>(2)), three = upload(std::vector<float>(3));
        run(program, "add_many", 1, cl_uint{count}, even, odd, two, three);
        float plain = 0.0F;
        for (std::uint32_t i = 0; i < count; ++i)
            plain += i % 2 == 0 ? even : odd;
        const double expected = 0.5 * count * (double{even} + odd);
        const std::vector<float> pair = two.read(test_device()), triple = three.read(test_device());
        // Two parts hold 48 bits: each addition loses at most 2^-48 of the sum, a million of them 4e-9.
        EXPECT_NEAR((double{pair[0]} + pair[1]) / expected, 1.0, 4e-9) << "samples of " << even << " and " << odd;
        // Three parts lose less than this double can show; the terms' sum is rounded once.
        EXPECT_NEAR((double{triple[0]} + (double{triple[1]} + triple[2])) / expected, 1.0, 3e-16);
        EXPECT_GT(std::abs(plain / expected - 1.0), 1e-4) << "the test is too easy: a plain sum does as well";
    }
}

/// Samples of many sizes and both signs in one order, and shared out among films, in other orders, that are added up:
/// every bit of the means is the same.
TEST_F(KernelFilm, OrderAndSharingDoNotShow) {
    build(false);
    constexpr std::size_t pixels = 256, passes = 120;
    Random random(41);
    std::vector<std::vector<VisiblePoint>> samples(passes);
    for (auto& points : samples) {
        for (std::size_t i = 0; i < pixels; ++i) {
            const float size = std::exp2(static_cast<float>(i % 32) * (random() - 0.5F));
            points.push_back(direct_only(size * random(), i % 2 == 0 ? size : size * (random() - 0.5F), -size));
        }
    }
    const std::vector<cl_float4> dark(pixels);
    const std::vector<float> radii(pixels, 1.0F);
    const Buffer<FilmPixel> whole = cleared(radii);
    for (const auto& points : samples)
        add(points, dark, whole);
    const FilmImage expected = develop_film(whole.read(test_device()), 16, 16, {0, 0, 16, 16});

    const std::array<Buffer<FilmPixel>, 3> parts{cleared(radii), cleared(radii), cleared(radii)};
    for (std::size_t pass = passes; pass-- > 0;)
        add(samples[pass], dark, parts[pass * pass % 3 == 0 ? pass % 2 : 2]);
    std::vector<FilmPixel> sum = parts[2].read(test_device());
    for (const std::size_t part : {1, 0})
        add_film(sum, parts[part].read(test_device()));
    const FilmImage shared = develop_film(sum, 16, 16, {0, 0, 16, 16});
    EXPECT_EQ(shared.passes, passes);
    EXPECT_EQ(shared.xyz, expected.xyz);
    // A difference of mean squares, each within 2^-47.
    for (std::size_t i = 0; i < pixels; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double mean = expected.xyz[i][c];
            EXPECT_NEAR(shared.variance[i][c], expected.variance[i][c],
                        0x1p-45 * mean * mean + 2.0 * unit_roundoff * expected.variance[i][c]);
        }
    }
}

TEST_F(KernelFilm, MeanAndVarianceOfPasses) {
    build(false);
    constexpr std::size_t pixels = 16;
    constexpr int passes = 500;
    const Buffer<FilmPixel> film = cleared(std::vector<float>(pixels, 1.0F));
    Random random(40);
    std::vector<std::array<Moments, 3>> moments(pixels);
    for (int pass = 0; pass < passes; ++pass) {
        std::vector<VisiblePoint> points;
        std::vector<cl_float4> flux;
        for (std::size_t i = 0; i < pixels; ++i) {
            VisiblePoint point = direct_only(random(), 10.0F * random(), -0.1F * random());
            point.slot = i % 4 == 0 ? SLOT_NONE : i % 4 == 1 ? SLOT_ALL : 2;
            point.radius = 0.1F + random();
            point.camera_rays = 2;
            point.shadow_rays = 1;
            points.push_back(point);
            flux.push_back({{random(), random(), random(), 5.0F}});
            const double area = std::acos(-1.0) * double{point.radius} * point.radius;
            const std::array<double, 3> direct{point.direct_x, point.direct_y, point.direct_z};
            for (std::size_t c = 0; c < 3; ++c)
                moments[i][c].add(direct[c] + (point.slot == SLOT_NONE ? 0.0 : flux.back().s[c] / area));
        }
        add(points, flux, film);
    }
    const std::vector<FilmPixel> sums = film.read(test_device());
    const FilmImage image = develop_film(sums, 4, 4, {0, 0, 4, 4});
    for (std::size_t i = 0; i < pixels; ++i) {
        EXPECT_EQ(sums[i].samples, static_cast<std::uint32_t>(passes));
        EXPECT_EQ(sums[i].camera_rays, 2U * passes);
        EXPECT_EQ(sums[i].shadow_rays, 1U * passes);
        for (std::size_t c = 0; c < 3; ++c) {
            const double mean = moments[i][c].mean(), error = moments[i][c].standard_error();
            // Each sample is rounded by a handful of float operations; the variance, a difference of mean squares,
            // feels that of the squares.
            EXPECT_NEAR(image.xyz[i][c], mean, 16.0 * unit_roundoff * std::abs(mean))
                << "pixel " << i << ", channel " << c;
            const double square = mean * mean + error * error * passes;
            EXPECT_NEAR(image.variance[i][c], error * error,
                        32.0 * unit_roundoff * square / (passes - 1) + 1e-6 * error * error)
                << "pixel " << i << ", channel " << c;
        }
    }
}

TEST_F(KernelFilm, SamplesThatAreNotFiniteAreCountedAndLeftOut) {
    build(false);
    const Buffer<FilmPixel> film = cleared(std::vector<float>(4, 1.0F));
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    std::vector<VisiblePoint> good(4, direct_only(1.0F, 2.0F, 3.0F));
    std::vector<VisiblePoint> bad = good;
    bad[1].direct_y = nan;
    bad[2].direct_z = -inf;
    bad[3].slot = SLOT_ALL;
    bad[3].radius = 1.0F;
    std::vector<cl_float4> flux(4, cl_float4{});
    flux[3].s[0] = inf;
    add(good, std::vector<cl_float4>(4, cl_float4{}), film);
    add(bad, flux, film);
    add(good, std::vector<cl_float4>(4, cl_float4{}), film);
    const std::vector<FilmPixel> sums = film.read(test_device());
    const FilmImage image = develop_film(sums, 2, 2, {0, 0, 2, 2});
    EXPECT_EQ(image.rejected_samples, 3U);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(sums[i].rejected, i == 0 ? 0U : 1U) << "pixel " << i;
        EXPECT_EQ(sums[i].samples, i == 0 ? 3U : 2U) << "pixel " << i;
        EXPECT_EQ(image.xyz[i], (std::array<float, 3>{1.0F, 2.0F, 3.0F})) << "pixel " << i;
    }
}

/// Hachisuka et al. 2008, equations 7 to 9: R² ← R² (N + αM)/(N + M), N ← N + αM.
TEST_F(KernelFilm, RadiusFollowsTheStatisticsOfItsPixel) {
    build(true);
    constexpr std::size_t pixels = 8;
    constexpr int passes = 2000;
    std::vector<float> radii;
    for (std::size_t i = 0; i < pixels; ++i)
        radii.push_back(0.5F + static_cast<float>(i));
    const Buffer<FilmPixel> film = cleared(radii);
    std::vector<double> squared, counts(pixels, 0.0);
    for (const float radius : radii)
        squared.push_back(double{radius} * radius);
    Random random(41);
    for (int pass = 0; pass < passes; ++pass) {
        std::vector<VisiblePoint> points(pixels, direct_only(0.0F, 0.0F, 0.0F));
        std::vector<cl_float4> flux(pixels, cl_float4{});
        for (std::size_t i = 0; i < pixels; ++i) {
            // Pixel 0 never sees a diffuse surface, pixel 1 never finds a photon.
            points[i].slot = i == 0 ? SLOT_NONE : SLOT_ALL;
            points[i].radius = 1.0F;
            const double found = i == 1 ? 0.0 : std::floor(random(0.0, 4.0 * static_cast<double>(i)));
            flux[i].s[3] = static_cast<float>(found);
            if (i >= 1 && found > 0.0) {
                squared[i] *= (counts[i] + alpha * found) / (counts[i] + found);
                counts[i] += alpha * found;
            }
        }
        add(points, flux, film);
    }
    const std::vector<FilmPixel> sums = film.read(test_device());
    for (std::size_t i = 0; i < pixels; ++i) {
        // A few units for each pass at most: quotient, square root, product.
        EXPECT_NEAR(sums[i].statistics_radius / std::sqrt(squared[i]), 1.0, passes * 8.0 * unit_roundoff)
            << "pixel " << i;
        EXPECT_NEAR(sums[i].statistics_count, counts[i], counts[i] * passes * unit_roundoff) << "pixel " << i;
    }
    EXPECT_EQ(sums[0].statistics_radius, radii[0]);
    EXPECT_EQ(sums[1].statistics_radius, radii[1]);
}

} // namespace
} // namespace tristim
