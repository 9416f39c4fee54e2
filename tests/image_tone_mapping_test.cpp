#include "image/tone_mapping.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <initializer_list>
#include <limits>
#include <random>

namespace tristim {
namespace {

using Kind = ToneMapping::Kind;

XyzImage image_of(const std::vector<std::array<float, 3>>& pixels) {
    const auto width = static_cast<int>(pixels.size());
    return {width, 1, {0, 0, width, 1}, pixels};
}

/// Greys of the colour of D65.
XyzImage greys(const std::vector<double>& luminances) {
    const Xyz white = rgb_to_xyz({1.0, 1.0, 1.0});
    std::vector<std::array<float, 3>> pixels;
    for (const double y : luminances)
        pixels.push_back({static_cast<float>(white[0] * y), static_cast<float>(y), static_cast<float>(white[2] * y)});
    return image_of(pixels);
}

/// A picture of many greys over ten stops.
std::vector<double> many_luminances() {
    std::mt19937 engine(3);
    std::uniform_real_distribution<double> stops(-6.0, 4.0);
    std::vector<double> luminances(10'000);
    for (double& y : luminances)
        y = std::exp2(stops(engine));
    return luminances;
}

int largest_step(const std::vector<std::array<std::uint8_t, 3>>& a, const std::vector<std::array<std::uint8_t, 3>>& b,
                 std::size_t count) {
    int largest = 0;
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            largest = std::max(largest, std::abs(a[i][c] - b[i][c]));
    }
    return largest;
}

TEST(ToneMapping, PhotographicFollowsThePaper) {
    // Three dark pixels and two bright ones: Y_mean = 0.01^(3/5); rank floor(0.995 · 4) = 3 of the sorted five: Y_high
    // = 1.
    const ToneCurve curve(greys({0.01, 1.0, 0.01, 1.0, 0.01}), {Kind::Photographic, 0.0});
    const double scale = 0.18 / std::pow(0.01, 0.6);
    ASSERT_GT(scale, 1.0); // L_white = scale · Y_high
    for (const double y : {0.001, 0.01, 0.3, 1.0, 5.0}) {
        const double l = scale * y;
        const double expected = l * (1.0 + l / (scale * scale)) / (1.0 + l);
        EXPECT_NEAR(curve(y), expected, 1e-6 * expected) << y; // the image holds floats
    }
    EXPECT_NEAR(curve(1.0), 1.0, 1e-6); // L_white is what maps to white
}

TEST(ToneMapping, LowContrastIsScaledOnly) {
    // Y_mean = 0.0064^(1/4) and Y_high = 0.4, the third of four: a · Y_high / Y_mean < 1.
    const ToneCurve curve(greys({0.1, 0.1, 0.4, 1.6}), {Kind::Photographic, 0.0});
    for (const double y : {0.01, 0.1, 1.6})
        EXPECT_NEAR(curve(y), 0.18 * y / std::pow(0.0064, 0.25), 1e-6 * y) << y;
}

TEST(ToneMapping, MidGreyIsEighteenPerCent) {
    const auto pixels = display_image(greys(std::vector<double>(64, 7.0)), {Kind::Photographic, 0.0});
    // IEC 61966-2-1: 255 (1.055 · 0.18^(1/2.4) - 0.055) = 117.6
    for (const auto& pixel : pixels)
        EXPECT_EQ(pixel, (std::array<std::uint8_t, 3>{118, 118, 118}));
}

TEST(ToneMapping, ExposureIsInStops) {
    const XyzImage image = greys({0.01, 1.0, 0.01, 1.0, 0.01});
    const ToneCurve plain(image, {Kind::Photographic, 0.0});
    const ToneCurve brighter(image, {Kind::Photographic, 3.0});
    const ToneCurve darker(image, {Kind::Photographic, -2.0});
    for (const double y : {0.001, 0.3, 5.0}) {
        EXPECT_DOUBLE_EQ(brighter(y), plain(8.0 * y));
        EXPECT_DOUBLE_EQ(darker(y), plain(0.25 * y));
        EXPECT_DOUBLE_EQ(ToneCurve(image, {Kind::Linear, 0.0})(y), y);
        EXPECT_DOUBLE_EQ(ToneCurve(image, {Kind::Linear, 3.0})(y), 8.0 * y);
    }
}

TEST(ToneMapping, AscendsAndKeepsBlack) {
    const XyzImage image = greys(many_luminances());
    for (const Kind kind : {Kind::Photographic, Kind::Linear}) {
        for (const double exposure : {-10.0, 0.0, 10.0}) {
            const ToneCurve curve(image, {kind, exposure});
            EXPECT_EQ(curve(0.0), 0.0);
            EXPECT_EQ(curve(-1.0), 0.0);
            EXPECT_EQ(curve.display_rgb({0.0, 0.0, 0.0}), (Rgb{0.0, 0.0, 0.0}));
            double last = 0.0;
            for (double stops = -40.0; stops < 40.0; stops += 0.125) {
                const double y = curve(std::exp2(stops));
                EXPECT_GT(y, last) << stops;
                last = y;
            }
        }
    }
}

TEST(ToneMapping, KeepsChromaticity) {
    const ToneCurve curve(greys({0.01, 1.0, 0.01, 1.0, 0.01}), {Kind::Photographic, 0.0});
    const Xyz xyz = rgb_to_xyz({0.2, 0.1, 0.05});
    const Rgb shown = curve.display_rgb(xyz);
    const double gain = curve(xyz[1]) / xyz[1];
    EXPECT_NEAR(shown[0], 0.2 * gain, 1e-9);
    EXPECT_NEAR(shown[1], 0.1 * gain, 1e-9);
    EXPECT_NEAR(shown[2], 0.05 * gain, 1e-9);
    EXPECT_GT(std::abs(gain - 1.0), 0.1);
}

TEST(ToneMapping, BlackPixelsDoNotTell) {
    std::vector<double> luminances = many_luminances();
    const auto bare = display_image(greys(luminances), {});
    luminances.resize(10 * luminances.size(), 0.0);
    const auto framed = display_image(greys(luminances), {});
    EXPECT_EQ(largest_step(bare, framed, bare.size()), 0);
    EXPECT_EQ(framed.back(), (std::array<std::uint8_t, 3>{0, 0, 0}));
}

TEST(ToneMapping, NearlyBlackPixelsDoNotTell) {
    std::vector<double> luminances(30, 0.01);
    luminances.resize(50, 1.0);
    const ToneCurve bare(greys(luminances), {});
    luminances.resize(500, 1e-9);
    const ToneCurve framed(greys(luminances), {}); // rank floor(0.995 · 499) = 496 is still among the twenty of Y = 1
    for (const double y : {0.001, 0.01, 1.0})
        EXPECT_DOUBLE_EQ(bare(y), framed(y));
}

TEST(ToneMapping, PhotographicIgnoresAbsoluteScale) {
    std::vector<double> luminances = many_luminances();
    const auto original = display_image(greys(luminances), {});
    for (double& y : luminances)
        y *= 1024.0;
    const auto scaled = display_image(greys(luminances), {});
    EXPECT_LE(largest_step(original, scaled, original.size()), 1); // rounding of a value between two steps
}

TEST(ToneMapping, AFireflyDoesNotDarkenThePicture) {
    std::vector<double> luminances = many_luminances();
    const auto original = display_image(greys(luminances), {});
    luminances.push_back(1e9);
    const auto with_firefly = display_image(greys(luminances), {});
    // The log-average grows by (1e9 / 0.5)^(1/10001) = 1.002: a fifth of a step at mid-grey.
    EXPECT_LE(largest_step(original, with_firefly, original.size()), 1);
    EXPECT_EQ(with_firefly.back(), (std::array<std::uint8_t, 3>{255, 255, 255}));
}

TEST(ToneMapping, OddPixelsAreHarmless) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    constexpr float infinity = std::numeric_limits<float>::infinity();
    XyzImage image = greys(many_luminances());
    const auto original = display_image(image, {});
    const std::vector<std::array<float, 3>> odd{
        {nan, nan, nan},       {0.1f, nan, 0.1f},   {infinity, infinity, infinity},
        {-1.0f, -1.0f, -1.0f}, {0.5f, -0.5f, 0.5f}, {-infinity, 0.1f, 0.1f}};
    image.xyz.insert(image.xyz.end(), odd.begin(), odd.end());
    const auto pixels = display_image(image, {});
    EXPECT_EQ(largest_step(original, pixels, original.size()), 0);
    for (const std::size_t i : {0, 1, 2, 3, 5})
        EXPECT_EQ(pixels[original.size() + i], (std::array<std::uint8_t, 3>{0, 0, 0})) << i;

    const ToneCurve curve(image, {});
    for (const float largest : {std::numeric_limits<float>::max(), std::numeric_limits<float>::denorm_min()}) {
        for (const double channel : curve.display_rgb({largest, largest, largest}))
            EXPECT_TRUE(channel >= 0.0 && channel <= 1.0) << channel;
    }
}

TEST(ToneMapping, ImagesWithoutLightAreBlack) {
    for (const XyzImage& image : {greys({0.0, 0.0}), greys({-1.0, 0.0}), XyzImage{}}) {
        for (const auto& pixel : display_image(image, {}))
            EXPECT_EQ(pixel, (std::array<std::uint8_t, 3>{0, 0, 0}));
    }
}

TEST(ToneMapping, SrgbCurveIsTheStandards) {
    EXPECT_EQ(srgb_encode(0.0), 0.0);
    EXPECT_NEAR(srgb_encode(1.0), 1.0, 1e-15);
    EXPECT_NEAR(srgb_encode(0.001), 0.01292, 1e-15);
    // The linear and the power part meet within 3e-8 with the constants of IEC 61966-2-1.
    EXPECT_NEAR(srgb_encode(0.0031308), srgb_encode(std::nextafter(0.0031308, 1.0)), 3e-8);
    // The inverse curve of the standard: ((v + 0.055) / 1.055)^2.4.
    for (const double v : {0.05, 0.25, 0.5, 0.75})
        EXPECT_NEAR(srgb_encode(std::pow((v + 0.055) / 1.055, 2.4)), v, 1e-14);
}

} // namespace
} // namespace tristim
