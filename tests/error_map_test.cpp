// Error maps: the errors, their common scale and their colours.
#include "image/error_map.h"
#include "png_pixels.h"
#include "scene_folder.h"

#include <cmath>
#include <limits>

namespace tristim::test {
namespace {

XyzImage row_of(const std::vector<std::array<float, 3>>& xyz) {
    const int width = static_cast<int>(xyz.size());
    return {width, 1, {0, 0, width, 1}, xyz};
}

TEST(ErrorMaps, ErrorsOfPixels) {
    const XyzImage image = row_of({{1, 2, 3}, {1, 1, 1}, {0, 0, 0}, {-1, 0, 0}});
    const XyzImage reference = row_of({{1, 2, 3}, {0, 0, 0}, {3, 0, 0}, {1, -1, 2}});
    // sqrt of the mean of the squares: 0, 1, sqrt(9/3), sqrt((4 + 1 + 4)/3)
    const std::vector<float> expected{0.0f, 1.0f, std::sqrt(3.0f), std::sqrt(3.0f)};
    const std::vector<float> errors = pixel_errors(image, reference);
    ASSERT_EQ(errors.size(), expected.size());
    for (std::size_t i = 0; i < errors.size(); ++i)
        EXPECT_FLOAT_EQ(errors[i], expected[i]) << i;
}

TEST(ErrorMaps, ImagesOfOtherSizes) {
    const XyzImage two = row_of({{1, 1, 1}, {1, 1, 1}});
    XyzImage shifted = two;
    shifted.full_width = 3;
    shifted.region.x = 1;
    const SceneFolder folder;
    for (const XyzImage& other : {row_of({{1, 1, 1}}), shifted}) {
        expect_message(error_of([&] { pixel_errors(two, other); }), "the images differ in size", "2x1");
        expect_message(error_of([&] { write_error_map(folder.path("map.png"), two, other, 1.0); }),
                       "the images differ in size", "2x1");
        EXPECT_FALSE(std::filesystem::exists(folder.path("map.png")));
    }
}

TEST(ErrorMaps, ScaleIsRoundedUpAndOneForAllMaps) {
    const auto scale = [](const std::vector<std::vector<float>>& maps) { return error_map_scale(maps); };
    EXPECT_DOUBLE_EQ(scale({{0.1f}}), 0.1);
    EXPECT_DOUBLE_EQ(scale({{0.11f}}), 0.2);
    EXPECT_DOUBLE_EQ(scale({{0.21f}}), 0.5);
    EXPECT_DOUBLE_EQ(scale({{0.51f}}), 1.0);
    EXPECT_DOUBLE_EQ(scale({{3e-5f}}), 5e-5);
    EXPECT_DOUBLE_EQ(scale({{7000.0f}}), 1e4);
    EXPECT_DOUBLE_EQ(scale({{0.01f, 0.02f}, {}, {0.3f}}), 0.5);
    // 99 of 100 pixels decide; what is black in both images and what is not a number do not count.
    std::vector<float> errors(99, 0.04f);
    errors.push_back(1000.0f);
    EXPECT_DOUBLE_EQ(scale({errors}), 0.05);
    EXPECT_DOUBLE_EQ(scale({errors, std::vector<float>(100'000, 0.0f)}), 0.05);
    errors.assign(2, 1000.0f);
    EXPECT_DOUBLE_EQ(scale({errors, std::vector<float>(98, 0.04f)}), 1000.0);
    constexpr float infinity = std::numeric_limits<float>::infinity();
    EXPECT_DOUBLE_EQ(scale({{0.04f, infinity, std::nanf("")}}), 0.05);
    EXPECT_EQ(scale({}), 0.0);
    EXPECT_EQ(scale({{0.0f, 0.0f}, {}}), 0.0);
}

TEST(ErrorMaps, PositionsAreLogarithmic) {
    EXPECT_EQ(error_map_position(0.5, 0.5), 1.0);
    EXPECT_EQ(error_map_position(80.0, 0.5), 1.0);
    EXPECT_NEAR(error_map_position(0.05, 0.5), 1.0 - 1.0 / error_map_decades, 1e-12);
    EXPECT_NEAR(error_map_position(0.5 * std::pow(10.0, -error_map_decades / 2.0), 0.5), 0.5, 1e-12);
    EXPECT_EQ(error_map_position(0.5 * std::pow(10.0, -error_map_decades - 1.0), 0.5), 0.0);
    EXPECT_EQ(error_map_position(0.0, 0.5), 0.0);
    EXPECT_EQ(error_map_position(0.0, 0.0), 0.0); // no error anywhere
    EXPECT_EQ(error_map_position(1e-9, 0.0), 1.0);
    EXPECT_EQ(error_map_position(std::numeric_limits<double>::infinity(), 0.5), 1.0);
    EXPECT_EQ(error_map_position(std::nan(""), 0.5), 1.0);
}

double decode_srgb(double value) {
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

TEST(ErrorMaps, BrighterColoursMeanGreaterErrors) {
    double previous = -1.0;
    for (int i = 0; i <= 1000; ++i) {
        const double t = i / 1000.0;
        const Rgb colour = error_map_colour(t);
        // What the helix is built for: its plane is that of equal perceived intensity, as Green 2011 weighs it (0.30 R
        // + 0.59 G + 0.11 B). The coefficients' five decimals leave it off by at most amplitude 1/8 times 1e-5.
        EXPECT_NEAR(0.30 * colour[0] + 0.59 * colour[1] + 0.11 * colour[2], t, 2e-6);
        const double luminance =
            0.2126 * decode_srgb(colour[0]) + 0.7152 * decode_srgb(colour[1]) + 0.0722 * decode_srgb(colour[2]);
        EXPECT_GT(luminance, previous) << t;
        previous = luminance;
    }
    EXPECT_EQ(error_map_colour(0.0), (Rgb{0.0, 0.0, 0.0}));
    EXPECT_EQ(error_map_colour(1.0), (Rgb{1.0, 1.0, 1.0}));
    EXPECT_EQ(error_map_colour(-1.0), error_map_colour(0.0));
    EXPECT_EQ(error_map_colour(2.0), error_map_colour(1.0));
    // At one third the angle is 2π (1/6 - 1/2) = -2π/3: cos = -1/2, sin = -sqrt(3)/2; the amplitude is 1/9.
    const Rgb third = error_map_colour(1.0 / 3.0);
    EXPECT_NEAR(third[0], 1.0 / 3.0 + (0.14861 / 2.0 - 1.78277 * std::sqrt(3.0) / 2.0) / 9.0, 1e-12);
    EXPECT_NEAR(third[1], 1.0 / 3.0 + (0.29227 / 2.0 + 0.90649 * std::sqrt(3.0) / 2.0) / 9.0, 1e-12);
    EXPECT_NEAR(third[2], 1.0 / 3.0 - 1.97294 / 2.0 / 9.0, 1e-12);
}

TEST(ErrorMaps, PngHoldsTheColours) {
    const SceneFolder folder;
    const std::string path = folder.path("map.png");
    const XyzImage reference{2, 2, {0, 0, 2, 2}, {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}}};
    XyzImage image = reference;
    image.xyz[1] = {1.01f, 1.01f, 1.01f};
    image.xyz[2] = {1.1f, 1.1f, 1.1f};
    image.xyz[3] = {9, 1, 1};
    write_error_map(path, image, reference, 0.1);
    const Pixels pixels = read_png(path);
    ASSERT_EQ(pixels.width, 2);
    ASSERT_EQ(pixels.height, 2);
    EXPECT_EQ(pixels.rgb[0], (std::array<int, 3>{0, 0, 0}));
    EXPECT_EQ(pixels.rgb[3], (std::array<int, 3>{255, 255, 255}));
    const Rgb decade_below = error_map_colour(1.0 - 1.0 / error_map_decades);
    for (std::size_t c = 0; c < 3; ++c) {
        // 1.1f - 1 is 0.1 to 1e-6, so that its colour is white to less than one step; steps are rounded.
        EXPECT_EQ(pixels.rgb[2][c], 255);
        EXPECT_NEAR(pixels.rgb[1][c], 255.0 * decade_below[c], 0.51);
    }
}

} // namespace
} // namespace tristim::test
