#include "commands/compare.h"
#include "image/compare_images.h"
#include "image/write_image.h"
#include "scene_folder.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <string>
#include <vector>

namespace tristim {
namespace {

using test::error_of;
using test::SceneFolder;

XyzImage image_of(int full_width, int full_height, const Region& region, std::vector<std::array<float, 3>> xyz) {
    return {full_width, full_height, region, std::move(xyz)};
}

const XyzImage image_a = image_of(2, 1, {0, 0, 2, 1}, {{0.5f, 0.25f, 0.0f}, {1.0f, 1.0f, 1.0f}});
const XyzImage image_b = image_of(2, 1, {0, 0, 2, 1}, {{0.25f, 0.25f, 0.5f}, {1.0f, 0.5f, 1.0f}});

std::string run_compare(std::vector<std::string> arguments) {
    CLI::App app;
    add_compare_command(app);
    std::reverse(arguments.begin(), arguments.end()); // CLI11 takes them from the back
    arguments.push_back("compare");
    testing::internal::CaptureStdout();
    try {
        app.parse(arguments);
    } catch (...) {
        testing::internal::GetCapturedStdout();
        throw;
    }
    return testing::internal::GetCapturedStdout();
}

TEST(CompareImages, MeasuresAreThoseOfTheFormulas) {
    const ImageDifference d = compare_images(image_a, image_b);
    // Differences: 0.25, 0, -0.5 and 0, 0.5, 0.
    EXPECT_DOUBLE_EQ(d.rmse, std::sqrt(0.5625 / 6.0));
    EXPECT_DOUBLE_EQ(d.rel_mse, (0.0625 / 0.0725 + 0.25 / 0.26 + 0.25 / 0.26) / 6.0);
    EXPECT_DOUBLE_EQ(d.psnr, 10.0 * std::log10(0.5 * 0.5 / 0.125));
    EXPECT_EQ(d.mean_xyz_a, (Xyz{0.75, 0.625, 0.5}));
    EXPECT_EQ(d.mean_xyz_b, (Xyz{0.625, 0.375, 0.75}));
    EXPECT_EQ(d.pixels, 2);
}

TEST(CompareImages, TheSecondIsTheReference) {
    const ImageDifference d = compare_images(image_b, image_a);
    EXPECT_DOUBLE_EQ(d.rel_mse, (0.0625 / 0.26 + 0.25 / 0.01 + 0.25 / 1.01) / 6.0);
    EXPECT_DOUBLE_EQ(d.psnr, 10.0 * std::log10(1.0 / 0.125));
}

TEST(CompareImages, EqualImages) {
    const ImageDifference d = compare_images(image_a, image_a);
    EXPECT_EQ(d.rmse, 0.0);
    EXPECT_EQ(d.rel_mse, 0.0);
    EXPECT_TRUE(std::isinf(d.psnr) && d.psnr > 0.0);
}

TEST(CompareImages, BlackReferenceHasNoPsnr) {
    const XyzImage black = image_of(2, 1, {0, 0, 2, 1}, {{}, {}});
    EXPECT_TRUE(std::isnan(compare_images(image_a, black).psnr));
}

TEST(CompareImages, RegionIsInPixelsOfTheWholeImage) {
    // a: 4×3 whole, X = 10 y + x. b: the same, a data window of 2×2 at (1, 1) off by one in its last pixel.
    XyzImage a = image_of(4, 3, {0, 0, 4, 3}, {});
    for (int i = 0; i < 12; ++i)
        a.xyz.push_back({static_cast<float>(10 * (i / 4) + i % 4), 1.0f, 0.0f});
    const XyzImage b = image_of(9, 9, {1, 1, 2, 2},
                                {{11.0f, 1.0f, 0.0f}, {12.0f, 1.0f, 0.0f}, {21.0f, 1.0f, 0.0f}, {23.0f, 1.0f, 0.0f}});
    EXPECT_EQ(compare_images(a, b, {1, 1, 1, 2}).rmse, 0.0);
    EXPECT_DOUBLE_EQ(compare_images(a, b, {1, 1, 2, 2}).rmse, std::sqrt(1.0 / 12.0));
    EXPECT_EQ(compare_images(a, b, {2, 2, 1, 1}).mean_xyz_a, (Xyz{22.0, 1.0, 0.0}));

    for (const Region& outside : {Region{0, 1, 2, 2}, Region{1, 0, 1, 2}, Region{1, 1, 3, 1}, Region{1, 1, 1, 3}}) {
        const std::string message = error_of([&] { compare_images(a, b, outside); });
        EXPECT_NE(message.find("first is 4x3, the second 9x9 with pixels in 1,1,3,3"), std::string::npos) << message;
    }
}

TEST(CompareImages, SizesMustAgreeWithoutRegion) {
    const XyzImage other = image_of(1, 2, {0, 0, 1, 2}, image_a.xyz);
    const std::string message = error_of([&] { compare_images(image_a, other); });
    EXPECT_NE(message.find("first is 2x1, the second 1x2"), std::string::npos) << message;

    const XyzImage window = image_of(2, 1, {1, 0, 1, 1}, {{}});
    EXPECT_NE(error_of([&] { compare_images(image_a, window); }).find("pixels in 1,0,2,1"), std::string::npos);
}

TEST(ParseRegion, ReadsHalfOpenCorners) {
    EXPECT_EQ(parse_region("0,0,1,1"), (Region{0, 0, 1, 1}));
    EXPECT_EQ(parse_region("33,49,139,156"), (Region{33, 49, 106, 107}));
}

TEST(ParseRegion, ErrorsNameTheText) {
    for (const std::string text : {"", "1", "0,0,1", "0,0,1,1,", "0,0,1,1,1", "0,0,1,x", "0,0,1.5,2", " 0,0,1,1",
                                   "-1,0,2,2", "0,0,99999999999,1", "0 0 1 1", "3,0,3,1", "0,2,1,1"}) {
        const std::string message = error_of([&] { parse_region(text); });
        EXPECT_NE(message.find("bad region '" + text + "'"), std::string::npos) << message;
    }
}

TEST(CompareCommand, JsonHoldsTheMeasures) {
    const SceneFolder folder;
    write_exr(folder.path("a.exr"), image_a, ColourSpace::CieXyz, {});
    write_exr(folder.path("b.exr"), image_b, ColourSpace::CieXyz, {});
    const auto json = nlohmann::json::parse(run_compare({folder.path("a.exr"), folder.path("b.exr"), "--json"}));
    const ImageDifference d = compare_images(image_a, image_b);
    EXPECT_EQ(json.size(), 6u);
    EXPECT_EQ(json.at("rmse"), d.rmse);
    EXPECT_EQ(json.at("relmse"), d.rel_mse);
    EXPECT_EQ(json.at("psnr"), d.psnr);
    EXPECT_EQ(json.at("mean_xyz_a").get<Xyz>(), d.mean_xyz_a);
    EXPECT_EQ(json.at("mean_xyz_b").get<Xyz>(), d.mean_xyz_b);
    EXPECT_EQ(json.at("pixels"), 2);

    const auto equal = nlohmann::json::parse(run_compare({folder.path("a.exr"), folder.path("a.exr"), "--json"}));
    EXPECT_TRUE(equal.at("psnr").is_null());
}

TEST(CompareCommand, TableAndRegion) {
    const SceneFolder folder;
    write_exr(folder.path("a.exr"), image_a, ColourSpace::CieXyz, {});
    write_exr(folder.path("b.exr"), image_b, ColourSpace::CieXyz, {});
    const std::string table = run_compare({folder.path("a.exr"), folder.path("b.exr"), "--region", "1,0,2,1"});
    EXPECT_NE(table.find("RMSE        0.288675 "), std::string::npos) << table; // sqrt(0.25 / 3)
    EXPECT_NE(table.find("PSNR of Y   0 dB"), std::string::npos) << table;      // error and peak are both 0.5
    EXPECT_NE(table.find("mean XYZ, A 1, 1, 1"), std::string::npos) << table;
    EXPECT_NE(table.find("mean XYZ, B 1, 0.5, 1"), std::string::npos) << table;
    EXPECT_NE(table.find("pixels      1\n"), std::string::npos) << table;
}

TEST(CompareCommand, BadInputIsAnError) {
    const SceneFolder folder;
    write_exr(folder.path("a.exr"), image_a, ColourSpace::Srgb, {});
    const std::string a = folder.path("a.exr");
    EXPECT_NE(error_of([&] { run_compare({a, folder.path("none.exr")}); }).find("none.exr"), std::string::npos);
    EXPECT_NE(error_of([&] { run_compare({a, a, "--region", "0,0,3,1"}); }).find("0,0,3,1"), std::string::npos);
    EXPECT_NE(error_of([&] { run_compare({a, a, "--region", "0,0"}); }).find("bad region"), std::string::npos);
    EXPECT_THROW(run_compare({a}), CLI::RequiredError);
    EXPECT_THROW(run_compare({a, a, "--unknown"}), CLI::ExtrasError);
}

} // namespace
} // namespace tristim
