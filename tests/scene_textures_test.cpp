// Textures and their use as film thickness, as scene files give them, and what is wrong with them or with texture
// coordinates.

#include "scene_folder.h"

#include <OpenImageIO/imageio.h>

#include <cmath>
#include <memory>
#include <ostream>

namespace tristim {
namespace {

using test::error_of;
using test::expect_message;
using test::SceneFolder;
using test::with_lit_world;
using test::with_world;

const std::string use = "\nMaterial \"dielectric\" \"float filmeta\" 1.3 \"texture filmthickness\" \"t\""
                        "\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n";

Scene load(const SceneFolder& folder, const std::string& directives) {
    return folder.load(with_world("LightSource \"point\"\n" + directives + use));
}

/// The texture "t" that some directives define, as a film's thickness.
Texture texture(const std::string& directives) {
    const SceneFolder folder;
    const Scene scene = load(folder, directives);
    EXPECT_EQ(scene.materials.at(0).film.thickness_texture, 0);
    EXPECT_EQ(scene.textures.size(), 1u);
    return scene.textures.at(0);
}

double constant_thickness(const std::string& directives) {
    const SceneFolder folder;
    const Scene scene = load(folder, directives);
    EXPECT_TRUE(scene.textures.empty());
    EXPECT_EQ(scene.materials.at(0).film.thickness_texture, -1);
    return scene.materials.at(0).film.layers.at(0).thickness;
}

void write_image(const std::string& path, int width, int height, const std::vector<std::string>& channels,
                 OIIO::TypeDesc type, const std::vector<float>& values) {
    OIIO::ImageSpec spec(width, height, static_cast<int>(channels.size()), type);
    spec.channelnames = channels;
    for (std::size_t i = 0; i < channels.size(); ++i)
        spec.alpha_channel = channels[i] == "A" ? static_cast<int>(i) : spec.alpha_channel;
    spec["oiio:UnassociatedAlpha"] = 1;
    const auto output = OIIO::ImageOutput::create(path);
    ASSERT_TRUE(output && output->open(path, spec) && output->write_image(OIIO::TypeDesc::FLOAT, values.data()) &&
                output->close());
}

/// A 2 × 2 image of some values of 255ths, as "i.png", read with more parameters.
std::vector<float> png_texels(const std::vector<std::string>& channels, const std::vector<int>& values,
                              const std::string& parameters) {
    const SceneFolder folder;
    std::vector<float> shares;
    for (const int value : values)
        shares.push_back(static_cast<float>(value) / 255.0F);
    write_image(folder.path("i.png"), 2, 2, channels, OIIO::TypeDesc::UINT8, shares);
    const Scene scene =
        load(folder, "Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"i.png\" " + parameters);
    const Texture& image = scene.textures.at(0);
    EXPECT_EQ(image.kind, Texture::Kind::Image);
    EXPECT_EQ(image.width, 2);
    EXPECT_EQ(image.height, 2);
    return image.texels;
}

void expect_texels(const std::vector<float>& texels, const std::vector<double>& expected) {
    ASSERT_EQ(texels.size(), expected.size());
    for (std::size_t i = 0; i < texels.size(); ++i)
        EXPECT_NEAR(texels[i], expected[i], 2e-7 * std::max(1.0, expected[i])) << i; // two roundings to float
}

TEST(SceneTexture, ConstantsFoldToNumbers) {
    EXPECT_EQ(constant_thickness("Texture \"t\" \"float\" \"constant\" \"float value\" 250"), 250.0);
    EXPECT_EQ(constant_thickness("Texture \"t\" \"float\" \"constant\""), 1.0);
    EXPECT_EQ(constant_thickness("Texture \"a\" \"float\" \"constant\" \"float value\" 250 "
                                 "Texture \"t\" \"float\" \"scale\" \"texture tex\" \"a\" \"float scale\" 2"),
              500.0);
    EXPECT_EQ(constant_thickness("Texture \"a\" \"float\" \"constant\" \"float value\" 250 "
                                 "Texture \"t\" \"float\" \"mix\" \"texture tex1\" \"a\" \"float tex2\" 450 "
                                 "\"float amount\" 0.25"),
              300.0);
}

TEST(SceneTexture, BilerpHasPbrtsDefaults) {
    const Texture t = texture("Texture \"t\" \"float\" \"bilerp\"");
    EXPECT_EQ(t.kind, Texture::Kind::Bilinear);
    EXPECT_EQ(t.mapping, Texture::Mapping::Uv);
    EXPECT_EQ(t.corners, (std::array{0.0, 1.0, 0.0, 1.0}));
    EXPECT_EQ(t.uv_scale, (std::array{1.0, 1.0, 0.0, 0.0}));
    const Texture other = texture("Texture \"t\" \"float\" \"bilerp\" \"float v00\" 1 \"float v01\" 2 \"float v10\" 3 "
                                  "\"float v11\" 4 \"float uscale\" 0.5 \"float vscale\" 0.25 \"float udelta\" 0.125 "
                                  "\"float vdelta\" 0.0625 \"string mapping\" \"uv\"");
    EXPECT_EQ(other.corners, (std::array{1.0, 2.0, 3.0, 4.0}));
    EXPECT_EQ(other.uv_scale, (std::array{0.5, 0.25, 0.125, 0.0625}));
}

TEST(SceneTexture, MappingsLiveInTheSpaceOfTheirDirective) {
    // A point (3, 4, 5) of the texture's space lies at (3·2 + 10, 4·2, 5·2) in the world.
    const V3d world(16, 8, 10);
    const auto mapped = [&](const std::string& parameters) {
        return texture("AttributeBegin Translate 10 0 0 Scale 2 2 2 Texture \"t\" \"float\" \"bilerp\" " + parameters +
                       " AttributeEnd");
    };
    const Texture spherical = mapped("\"string mapping\" \"spherical\"");
    EXPECT_EQ(spherical.mapping, Texture::Mapping::Spherical);
    EXPECT_EQ(world * spherical.world_to_texture, V3d(3, 4, 5));
    const Texture cylindrical =
        mapped("\"string mapping\" \"cylindrical\" \"float v00\" 1 \"float v01\" 1 \"float v10\" 1 \"float v11\" 1");
    EXPECT_EQ(cylindrical.mapping, Texture::Mapping::Cylindrical);
    EXPECT_EQ(world * cylindrical.world_to_texture, V3d(3, 4, 5));
    const Texture planar =
        mapped("\"string mapping\" \"planar\" \"float v00\" 9 \"float v01\" 9 \"float v10\" 9 \"float v11\" 9");
    EXPECT_EQ(planar.mapping, Texture::Mapping::Planar);
    EXPECT_EQ((world * planar.world_to_texture).x, 3.0);
    EXPECT_EQ((world * planar.world_to_texture).y, 4.0);
    const Texture skewed = mapped("\"string mapping\" \"planar\" \"vector3 v1\" [1 0 2] \"vector3 v2\" [0 -1 1] "
                                  "\"float udelta\" 0.5 \"float vdelta\" 0.25 \"float v00\" 9 \"float v01\" 9 "
                                  "\"float v10\" 9 \"float v11\" 9");
    EXPECT_EQ((world * skewed.world_to_texture).x, 3.0 + 2.0 * 5.0 + 0.5);
    EXPECT_EQ((world * skewed.world_to_texture).y, -4.0 + 5.0 + 0.25);
}

TEST(SceneTexture, PngIsSrgbUnlessToldOtherwise) {
    const std::vector<int> values{0, 10, 128, 255};
    // IEC 61966-2-1, below and above 0.04045.
    const double low = 10.0 / 255.0 / 12.92, high = std::pow((128.0 / 255.0 + 0.055) / 1.055, 2.4);
    expect_texels(png_texels({"Y"}, values, ""), {0.0, low, high, 1.0});
    expect_texels(png_texels({"Y"}, values, "\"string encoding\" \"sRGB\""), {0.0, low, high, 1.0});
    expect_texels(png_texels({"Y"}, values, "\"string encoding\" \"linear\""), {0.0, 10.0 / 255.0, 128.0 / 255.0, 1.0});
    expect_texels(png_texels({"Y"}, values, "\"string encoding\" \"gamma 2\""),
                  {0.0, std::pow(10.0 / 255.0, 2.0), std::pow(128.0 / 255.0, 2.0), 1.0});
}

TEST(SceneTexture, ImagesAreScaledThenInverted) {
    const std::vector<int> values{0, 51, 204, 255};
    const std::string linear = "\"string encoding\" \"linear\" ";
    expect_texels(png_texels({"Y"}, values, linear + "\"float scale\" 500"), {0.0, 100.0, 400.0, 500.0});
    expect_texels(png_texels({"Y"}, values, linear + "\"float scale\" 0.5 \"bool invert\" true"), {1.0, 0.9, 0.6, 0.5});
    // pbrt clamps inverted values at 0.
    expect_texels(png_texels({"Y"}, values, linear + "\"float scale\" 2 \"bool invert\" true"), {1.0, 0.6, 0.0, 0.0});
}

TEST(SceneTexture, ColoursCountAsTheirMeanAndAlphaComesFirst) {
    const std::string linear = "\"string encoding\" \"linear\"";
    expect_texels(png_texels({"Y", "A"}, {51, 255, 102, 0, 0, 0, 255, 51}, linear), {0.2, 0.4, 0.0, 1.0});
    const std::vector<int> rgb{51, 102, 153, 0, 0, 0, 255, 255, 255, 255, 0, 0};
    expect_texels(png_texels({"R", "G", "B"}, rgb, linear), {0.4, 0.0, 1.0, 1.0 / 3.0});
    const std::vector<int> opaque{51, 102, 153, 255, 0, 0, 0, 255, 255, 255, 255, 255, 255, 0, 0, 255};
    expect_texels(png_texels({"R", "G", "B", "A"}, opaque, linear), {0.4, 0.0, 1.0, 1.0 / 3.0});
    const std::vector<int> clear{51, 102, 153, 255, 0, 0, 0, 51, 255, 255, 255, 102, 255, 0, 0, 0};
    expect_texels(png_texels({"R", "G", "B", "A"}, clear, linear), {1.0, 0.2, 0.4, 0.0});
}

TEST(SceneTexture, FloatImagesAreLinearAndTopRowFirst) {
    const SceneFolder folder;
    write_image(folder.path("i.exr"), 3, 2, {"Y"}, OIIO::TypeDesc::FLOAT, {1.5F, 2.5F, 3.5F, 4.5F, 5.5F, 6.5F});
    for (const char* encoding : {"", " \"string encoding\" \"sRGB\""}) {
        const Scene scene =
            load(folder, fmt::format("Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"i.exr\"{}", encoding));
        const Texture& image = scene.textures.at(0);
        EXPECT_EQ(image.width, 3);
        EXPECT_EQ(image.height, 2);
        EXPECT_EQ(image.texels, (std::vector<float>{1.5F, 2.5F, 3.5F, 4.5F, 5.5F, 6.5F}));
        EXPECT_EQ(image.wrap, Texture::Wrap::Repeat);
    }
}

TEST(SceneTexture, ImagesWrapAndTellWhatLiesOutside) {
    const SceneFolder folder;
    write_image(folder.path("i.exr"), 1, 1, {"Y"}, OIIO::TypeDesc::FLOAT, {0.25F});
    const auto image = [&](const std::string& parameters) {
        return load(folder, "Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"i.exr\" " + parameters)
            .textures.at(0);
    };
    EXPECT_EQ(image("\"string wrap\" \"clamp\"").wrap, Texture::Wrap::Clamp);
    EXPECT_EQ(image("\"string wrap\" \"repeat\"").wrap, Texture::Wrap::Repeat);
    const Texture black = image("\"string wrap\" \"black\"");
    EXPECT_EQ(black.wrap, Texture::Wrap::Black);
    EXPECT_EQ(black.outside, 0.0);
    EXPECT_EQ(image("\"string wrap\" \"black\" \"bool invert\" true").outside, 1.0);
}

TEST(SceneTexture, OtherFiltersAndAlphaAreNoted) {
    const SceneFolder folder;
    write_image(folder.path("i.png"), 1, 1, {"R", "G", "B", "A"}, OIIO::TypeDesc::UINT8, {0.2F, 0.2F, 0.2F, 0.4F});
    const Scene scene = load(folder, "Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"i.png\" "
                                     "\"string filter\" \"trilinear\" \"float maxanisotropy\" 4");
    ASSERT_EQ(scene.notes.size(), 2u);
    EXPECT_NE(scene.notes[0].find("scene.pbrt:4: "), std::string::npos) << scene.notes[0];
    EXPECT_NE(scene.notes[0].find("trilinear"), std::string::npos) << scene.notes[0];
    EXPECT_NE(scene.notes[1].find("alpha"), std::string::npos) << scene.notes[1];
}

TEST(SceneTexture, ScaleAndMixChangeOnePattern) {
    const std::string a = "Texture \"a\" \"float\" \"bilerp\" \"float v00\" 1 \"float v01\" 2 \"float v10\" 3 "
                          "\"float v11\" 4\nTexture \"c\" \"float\" \"constant\" \"float value\" 10\n"
                          "Texture \"t\" \"float\" ";
    EXPECT_EQ(texture(a + "\"scale\" \"texture tex\" \"a\" \"float scale\" 100").corners,
              (std::array{100.0, 200.0, 300.0, 400.0}));
    EXPECT_EQ(texture(a + "\"scale\" \"texture tex\" \"c\" \"texture scale\" \"a\"").corners,
              (std::array{10.0, 20.0, 30.0, 40.0}));
    EXPECT_EQ(texture(a + "\"mix\" \"texture tex1\" \"a\" \"texture tex2\" \"c\" \"float amount\" 0.25").corners,
              (std::array{3.25, 4.0, 4.75, 5.5}));
    EXPECT_EQ(texture(a + "\"mix\" \"texture tex1\" \"c\" \"texture tex2\" \"a\" \"float amount\" 0.25").corners,
              (std::array{7.75, 8.0, 8.25, 8.5}));
    EXPECT_EQ(texture(a + "\"mix\" \"float tex1\" 100 \"float tex2\" 200 \"texture amount\" \"a\"").corners,
              (std::array{200.0, 300.0, 400.0, 500.0}));
}

TEST(SceneTexture, MixedImagesChangeInsideAndOutside) {
    const SceneFolder folder;
    write_image(folder.path("i.exr"), 2, 1, {"Y"}, OIIO::TypeDesc::FLOAT, {0.25F, 0.5F});
    const Scene scene = load(folder, "Texture \"i\" \"float\" \"imagemap\" \"string filename\" \"i.exr\" "
                                     "\"string wrap\" \"black\"\nTexture \"t\" \"float\" \"mix\" \"float tex1\" 100 "
                                     "\"float tex2\" 300 \"texture amount\" \"i\"");
    EXPECT_EQ(scene.textures.at(0).texels, (std::vector<float>{150.0F, 200.0F}));
    EXPECT_EQ(scene.textures.at(0).outside, 100.0);
}

TEST(SceneTexture, OnlyUsedOnesAreKeptAndSharedOnesOnce) {
    const SceneFolder folder;
    const std::string film = "\"float filmeta\" 1.3 \"texture filmthickness\" ";
    const Scene scene = folder.load(with_world(
        "LightSource \"point\"\nTexture \"idle\" \"float\" \"bilerp\" Texture \"a\" \"float\" \"bilerp\" \"float v00\" "
        "7 "
        "Texture \"b\" \"float\" \"bilerp\" \"float v00\" 8\nMaterial \"dielectric\" " +
        film + "\"idle\" Material \"dielectric\" " + film + "\"b\" Shape \"sphere\" Material \"conductor\" " + film +
        "\"a\" Shape \"sphere\" Material \"diffuse\" " + film + "\"b\" Shape \"sphere\""));
    ASSERT_EQ(scene.textures.size(), 2u);
    const auto corner = [&](std::size_t shape) {
        const Film& f = scene.materials.at(static_cast<std::size_t>(scene.shapes.at(shape).material)).film;
        return scene.textures.at(static_cast<std::size_t>(f.thickness_texture)).corners[0];
    };
    EXPECT_EQ(corner(0), 8.0);
    EXPECT_EQ(corner(1), 7.0);
    EXPECT_EQ(corner(2), 8.0);
}

struct BadTexture {
    const char* label;
    std::string text; ///< begins at line 5
    int line;
    const char* words; ///< that the message must hold
};

void PrintTo(const BadTexture& bad, std::ostream* out) {
    *out << bad.label;
}

class TextureError : public testing::TestWithParam<BadTexture> {};

TEST_P(TextureError, NamesFileLineAndReason) {
    const SceneFolder folder;
    folder.write("broken.png", "\x89PNG nothing more");
    folder.write("text.png", "hello");
    write_image(folder.path("nan.exr"), 2, 1, {"Y"}, OIIO::TypeDesc::FLOAT, {1.0F, NAN});
    write_image(folder.path("negative.exr"), 2, 1, {"Y"}, OIIO::TypeDesc::FLOAT, {1.0F, -0.5F});
    write_image(folder.path("xy.exr"), 1, 1, {"X", "Z"}, OIIO::TypeDesc::FLOAT, {1.0F, 1.0F});
    const std::string message = error_of([&] { folder.load(with_lit_world(GetParam().text)); });
    expect_message(message, folder.path("scene.pbrt") + fmt::format(":{}: ", GetParam().line), GetParam().words);
}

std::string image_file(const std::string& name, const std::string& more = "") {
    return "Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"" + name + "\" " + more;
}
std::string bilerp(const std::string& parameters) {
    return "Texture \"t\" \"float\" \"bilerp\" " + parameters;
}

INSTANTIATE_TEST_SUITE_P(
    , TextureError,
    testing::Values(
        BadTexture{"MissingUv", "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n\"point2 uv\" [0 0 1 0]", 6,
                   "2 pairs for 3 vertices"},
        BadTexture{"OddUv", "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n\"point2 uv\" [0 0 1 0 1]", 6,
                   "pairs"},
        BadTexture{"HugeUv", "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n\"point2 uv\" [0 0 1 0 1e40 1]",
                   6, "too large"},
        BadTexture{"NoName", "Texture 3", 5, "Texture"},
        BadTexture{"NoKind", "Texture \"t\" \"float\"\nShape \"sphere\"", 5, "Texture"},
        BadTexture{"Spectrum", "Texture \"t\" \"spectrum\" \"constant\"", 5, "filmthickness"},
        BadTexture{"UnknownKind", "Texture \"t\" \"float\" \"marble\"", 5, "\"marble\""},
        BadTexture{"DefinedTwice", bilerp("") + "\n" + bilerp(""), 6, "defined already"},
        BadTexture{"UnknownParameter", bilerp("\n\"float v22\" 1"), 6, "v22"},
        BadTexture{"UnknownMapping", bilerp("\n\"string mapping\" \"toroidal\""), 6, "toroidal"},
        BadTexture{"PlanarScale", bilerp("\"string mapping\" \"planar\"\n\"float uscale\" 2"), 6, "uscale"},
        BadTexture{"SingularSpace", "Scale 1 1 0\n" + bilerp("\"string mapping\" \"planar\""), 6, "transformation"},
        BadTexture{"Perspective",
                   "Transform [1 0 0 0 0 1 0 0 0 0 1 1 0 0 0 1]\n" + bilerp("\"string mapping\" \"planar\""), 6,
                   "perspective"},
        BadTexture{"NoFileName", "Texture \"t\" \"float\" \"imagemap\"", 5, "filename"},
        BadTexture{"MissingFile", image_file("absent.png"), 5, "absent.png"},
        BadTexture{"Folder", image_file("."), 5, "folder"},
        BadTexture{"BrokenFile", image_file("broken.png"), 5, "broken.png"},
        BadTexture{"NoImage", image_file("text.png"), 5, "text.png"},
        BadTexture{"NanTexel", image_file("nan.exr"), 5, "(1, 0)"},
        BadTexture{"OtherChannels", image_file("xy.exr"), 5, "R, G and B"},
        BadTexture{"UnknownWrap", image_file("nan.exr", "\n\"string wrap\" \"mirror\""), 6, "mirror"},
        BadTexture{"UnknownFilter", image_file("nan.exr", "\n\"string filter\" \"sharp\""), 6, "sharp"},
        BadTexture{"UnknownEncoding", image_file("nan.exr", "\n\"string encoding\" \"log\""), 6, "log"},
        BadTexture{"BadGamma", image_file("nan.exr", "\n\"string encoding\" \"gamma -2\""), 6, "gamma -2"},
        BadTexture{"UnknownOperand", "Texture \"t\" \"float\" \"scale\"\n\"texture tex\" \"wood\"", 6, "wood"},
        BadTexture{"TwoPatternsScaled",
                   bilerp("") + "\nTexture \"s\" \"float\" \"scale\" \"texture tex\" \"t\" \"texture scale\" \"t\"", 6,
                   "constant"},
        BadTexture{"TwoPatternsMixed",
                   bilerp("") + "\nTexture \"s\" \"float\" \"mix\" \"texture tex1\" \"t\" \"texture tex2\" \"t\"", 6,
                   "constant"},
        BadTexture{"NearMatch",
                   bilerp("") + "\nMaterial \"diffuse\" \"float filmeta\" 1.3 \"texture filmthickness\" \"T\"", 6,
                   "did you mean t?"},
        BadTexture{"NegativeCorner", bilerp("\"float v10\" -3") + use, 6, "-3"},
        BadTexture{"NegativeTexel", image_file("negative.exr") + use, 6, "-0.5"},
        BadTexture{"NegativeConstant", "Texture \"t\" \"float\" \"constant\" \"float value\" -1" + use, 6, "-1"},
        BadTexture{"TooLarge", bilerp("\"float v10\" 1e39") + use, 5, "too large"},
        BadTexture{"TwoLayers",
                   bilerp("") + "\nMaterial \"diffuse\" \"float filmeta\" [1 2] \"texture filmthickness\" \"t\"", 6,
                   "\"filmeta\" has 2 layers, but a texture can only be the thickness of one"},
        BadTexture{"TwoTextures",
                   bilerp("") + "\nMaterial \"diffuse\" \"float filmeta\" 1 \"texture filmthickness\" [\"t\" \"t\"]", 6,
                   "filmthickness"},
        // 1 at u = 0, 0 at u = 1, so -1 at u = 2.
        BadTexture{"NegativeBeyondItsSquare",
                   bilerp("\"float v00\" 1 \"float v01\" 1 \"float v10\" 0 \"float v11\" 0 \"float uscale\" 2") + use,
                   7, "-1 nm"},
        // 1/64 + (u - 7/8)(v - 1/8) on the default coordinates: at least 0 at the corners, -1/8 in the diagonal's
        // middle.
        BadTexture{"NegativeInsideAnEdge",
                   bilerp("\"float v00\" 0.015625 \"float v01\" 0.015625 \"float v10\" 0.015625 \"float v11\" 1.015625 "
                          "\"float udelta\" -0.875 \"float vdelta\" -0.125") +
                       use,
                   7, "-0.125 nm"}),
    [](const auto& bad) { return bad.param.label; });

} // namespace
} // namespace tristim
