// Colours that no display shows: XYZ and linear RGB are kept in EXR files as they are, only what is displayed is cut
// off, and nothing that is negative, huge or not finite makes a NaN of a pixel.
#include "image/read_image.h"
#include "image/write_image.h"
#include "png_pixels.h"
#include "scene_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tristim::test {
namespace {

using Kind = ToneMapping::Kind;
using Float = std::numeric_limits<float>;

XyzImage image_of(const std::vector<std::array<float, 3>>& pixels) {
    const auto width = static_cast<int>(pixels.size());
    return {width, 1, {0, 0, width, 1}, pixels};
}

/// XYZ of every nanometre's light alone, as far from sRGB as colours get.
std::vector<std::array<float, 3>> monochromatic_colours() {
    std::vector<std::array<float, 3>> pixels;
    for (std::size_t i = 0; i < lambda_bins; ++i)
        pixels.push_back({static_cast<float>(cie_bins()[0][i]), static_cast<float>(cie_bins()[1][i]),
                          static_cast<float>(cie_bins()[2][i])});
    return pixels;
}

TEST(SpectrumStability, PureColoursAreKeptInExrFilesAndCutOffInPngFilesAlone) {
    const SceneFolder folder;
    const XyzImage image = image_of(monochromatic_colours());
    write_exr(folder.path("xyz.exr"), image, ColourSpace::CieXyz, {});
    EXPECT_EQ(read_exr(folder.path("xyz.exr")).xyz, image.xyz);

    write_exr(folder.path("rgb.exr"), image, ColourSpace::Srgb, {});
    const XyzImage read = read_exr(folder.path("rgb.exr"));
    write_png(folder.path("rgb.png"), image, {Kind::Linear, 0.0});
    const Pixels shown = read_png(folder.path("rgb.png"));
    ASSERT_EQ(shown.rgb.size(), image.xyz.size());
    int negative = 0;
    for (std::size_t i = 0; i < image.xyz.size(); ++i) {
        const auto& [x, y, z] = image.xyz[i];
        const Rgb rgb = xyz_to_rgb({x, y, z});
        for (std::size_t c = 0; c < 3; ++c) {
            // Half a unit of the last place of each of R, G and B and of the sum.
            double tolerance = 0x1p-24 * std::abs(image.xyz[i][c]) + 1e-12;
            for (std::size_t k = 0; k < 3; ++k)
                tolerance += 0x1p-24 * std::abs(rgb_to_xyz_matrix()[c][k] * rgb[k]);
            EXPECT_NEAR(read.xyz[i][c], image.xyz[i][c], tolerance) << 380 + i << " nm";
            negative += rgb[c] < 0.0 ? 1 : 0;
            // IEC 61966-2-1 of what is left of the channel within [0, 1].
            const double cut = std::clamp(rgb[c], 0.0, 1.0);
            const double encoded = cut <= 0.0031308 ? 12.92 * cut : 1.055 * std::pow(cut, 1.0 / 2.4) - 0.055;
            EXPECT_NEAR(shown.rgb[i][c], 255.0 * encoded, 0.5 + 1e-9) << 380 + i << " nm, channel " << c;
        }
    }
    EXPECT_GT(negative, lambda_bins / 2) << "these colours should lie outside of sRGB";
}

const std::vector<float>& hard_values() {
    static const std::vector<float> values{-Float::infinity(),
                                           -Float::max(),
                                           -1e20F,
                                           -1.0F,
                                           -1e-20F,
                                           -Float::denorm_min(),
                                           -0.0F,
                                           0.0F,
                                           Float::denorm_min(),
                                           Float::min(),
                                           1e-20F,
                                           0.18F,
                                           1.0F,
                                           1e20F,
                                           Float::max(),
                                           Float::infinity(),
                                           Float::quiet_NaN()};
    return values;
}

/// Every combination of hard X, Y and Z, in pictures of which some have such pixels alone, at exposures up to those
/// whose powers of two leave the range of double.
TEST(SpectrumStability, NoColourBecomesNotANumberOnTheDisplay) {
    std::vector<std::array<float, 3>> pixels;
    for (const float x : hard_values()) {
        for (const float y : hard_values()) {
            for (const float z : hard_values())
                pixels.push_back({x, y, z});
        }
    }
    const std::vector<std::vector<std::array<float, 3>>> pictures{pixels,
                                                                  {},
                                                                  {{0.3F, 0.3F, 0.3F}},
                                                                  {{1e-45F, 1e-45F, 1e-45F}},
                                                                  {{1e38F, 1e38F, 1e38F}, {1e-38F, 1e-38F, 1e-38F}},
                                                                  {{-1.0F, -1.0F, -1.0F}}};
    for (const auto& picture : pictures) {
        for (const Kind kind : {Kind::Photographic, Kind::Linear}) {
            for (const double exposure : {-5000.0, -1074.0, -200.0, 0.0, 200.0, 1023.0, 1024.0, 5000.0}) {
                const ToneCurve curve(image_of(picture), {kind, exposure});
                for (const auto& [x, y, z] : pixels) {
                    for (const double channel : curve.display_rgb({x, y, z})) {
                        ASSERT_TRUE(channel >= 0.0 && channel <= 1.0)
                            << channel << " of XYZ " << x << ", " << y << ", " << z << " at " << exposure << " stops";
                        const double encoded = srgb_encode(channel);
                        ASSERT_TRUE(encoded >= 0.0 && encoded <= 1.0) << channel;
                    }
                }
                double last = 0.0;
                for (const float y : hard_values()) {
                    if (std::isnan(y))
                        continue;
                    const double shown = curve(y);
                    ASSERT_GE(shown, last) << "the curve descends at " << y << ", " << exposure << " stops";
                    last = shown;
                }
            }
        }
    }
}

/// What is finite shows; at absurd exposures it is black or white.
TEST(SpectrumStability, AbsurdExposuresAreBlackOrWhite) {
    const XyzImage grey = image_of({{0.3F, 0.3F, 0.3F}, {0.0F, 0.0F, 0.0F}});
    for (const Kind kind : {Kind::Photographic, Kind::Linear}) {
        const auto bright = display_image(grey, {kind, 4000.0}), dark = display_image(grey, {kind, -4000.0});
        EXPECT_EQ(bright[0], (std::array<std::uint8_t, 3>{255, 255, 255}));
        EXPECT_EQ(bright[1], (std::array<std::uint8_t, 3>{0, 0, 0}));
        EXPECT_EQ(dark[0], (std::array<std::uint8_t, 3>{0, 0, 0}));
        EXPECT_EQ(dark[1], (std::array<std::uint8_t, 3>{0, 0, 0}));
    }
}

TEST(SpectrumStability, TransferCurveTakesWhatLiesOutsideOfItsRange) {
    for (const double value : {-1e300, -1.0, -1e-300, -0.0, 0.0, 1e-300, 2.0, 1e300})
        EXPECT_FALSE(std::isnan(srgb_encode(value))) << value;
    EXPECT_DOUBLE_EQ(srgb_encode(-0.5), -0.5 * 12.92);
}

} // namespace
} // namespace tristim::test
