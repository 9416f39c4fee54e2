// The parts of an image whose error is measured by itself.
#include "bench/regions.h"
#include "scene_folder.h"

#include <algorithm>

namespace tristim::test {
namespace {

/// A scene of 64×48 pixels in a folder, and the regions beside it.
class BenchRegions : public testing::Test {
  protected:
    BenchRegions() {
        scene.path = folder.path("scene.pbrt");
        scene.settings.width = 64;
        scene.settings.height = 48;
        resize(64, 48);
    }

    void resize(int width, int height) {
        options.width = width;
        options.height = height;
        options.region = {0, 0, width, height};
    }

    std::vector<NamedRegion> regions(const std::vector<std::string>& given = {}) const {
        return named_regions(scene, options, given);
    }

    void keep(const std::string& text) const { folder.write("scene.regions", text); }

    void expect_error(const std::vector<std::string>& given, const std::string& words) const {
        expect_message(error_of([&] { regions(given); }), "", words);
    }

    void expect_kept_error(const std::string& text, const std::string& line, const std::string& words) const {
        keep(text);
        expect_message(error_of([&] { regions(); }), folder.path("scene.regions") + ":" + line + ": ", words);
    }

    SceneFolder folder;
    Scene scene;
    RenderOptions options;
};

using Regions = std::vector<NamedRegion>;

TEST_F(BenchRegions, TheWholeImageIsTheFirst) {
    EXPECT_EQ(regions(), (Regions{{"image", {0, 0, 64, 48}}}));
    options.region = {8, 4, 32, 16};
    EXPECT_EQ(regions(), (Regions{{"image", {8, 4, 32, 16}}}));
}

TEST_F(BenchRegions, KeptOnesComeBeforeGivenOnes) {
    keep("# comment\n\nglass=8,4,16,12 # of the scene\r\n  metal = 0, 0, 64, 48\n");
    const NamedRegion image{"image", {0, 0, 64, 48}}, glass{"glass", {8, 4, 8, 8}}, metal{"metal", {0, 0, 64, 48}};
    EXPECT_EQ(regions(), (Regions{image, glass, metal}));
    EXPECT_EQ(regions({"own_1=1,2,3,5"}), (Regions{image, glass, metal, {"own_1", {1, 2, 2, 3}}}));
    EXPECT_EQ(regions({"glass=63,47,64,48"}), (Regions{image, metal, {"glass", {63, 47, 1, 1}}})) << "replaces it";
}

/// Pixels that the scaled border cuts count.
TEST_F(BenchRegions, KeptOnesScaleWithTheResolution) {
    keep("glass=9,4,17,13\n");
    resize(32, 24);
    EXPECT_EQ(regions().at(1), (NamedRegion{"glass", {4, 2, 5, 5}}));
    resize(128, 48);
    EXPECT_EQ(regions().at(1), (NamedRegion{"glass", {18, 4, 16, 9}}));
    resize(1, 1);
    EXPECT_EQ(regions().at(1), (NamedRegion{"glass", {0, 0, 1, 1}}));
    keep("all=0,0,64,48\n");
    for (const auto& [width, height] : {std::pair(1, 1), std::pair(7, 5), std::pair(63, 47), std::pair(1000, 999)}) {
        resize(width, height);
        EXPECT_EQ(regions().at(1).region, (Region{0, 0, width, height}));
    }
}

TEST_F(BenchRegions, KeptOnesOutsideTheRenderedPartAreLeftOut) {
    keep("left=0,0,8,8\nmiddle=20,20,30,30\n");
    options.region = {16, 16, 32, 32};
    EXPECT_EQ(regions(), (Regions{{"image", {16, 16, 32, 32}}, {"middle", {20, 20, 10, 10}}}));
    expect_error({"left=0,0,8,8"}, "'left=0,0,8,8' is not inside the rendered pixels 16,16,48,48");
}

TEST_F(BenchRegions, BadOnesAreRefused) {
    expect_error({"far=0,0,65,48"}, "'far=0,0,65,48' is not inside the rendered pixels 0,0,64,48");
    expect_error({"far=60,40,64,49"}, "is not inside the rendered pixels");
    expect_error({"a=0,0,8,8", "a=1,1,8,8"}, "region a comes twice");
    expect_error({"image=0,0,8,8"}, "other than image");
    for (const char* name : {"", "a b", "a/b", "ä", "a,b", ".."})
        expect_error({std::string(name) + "=0,0,8,8"}, "bad region '" + std::string(name));
    expect_error({"0,0,8,8"}, "expected NAME=X0,Y0,X1,Y1");
    expect_error({"glass"}, "expected NAME=X0,Y0,X1,Y1");
    for (const char* corners : {"", "0,0,8", "0,0,8,8,8", "0,0,8,x", "-1,0,8,8", "0,0,8.5,8", "0 0 8 8", "a=0,0,8,8"})
        expect_error({"a=" + std::string(corners)}, "expected X0,Y0,X1,Y1");
    for (const char* corners : {"8,0,8,8", "0,8,8,8", "9,0,8,8"})
        expect_error({"a=" + std::string(corners)}, "it holds no pixel");
}

TEST_F(BenchRegions, BadLinesOfKeptOnesAreNamed) {
    expect_kept_error("glass=0,0,8,8\n# fine\nmetal 0,0,8,8\n", "3", "expected NAME=X0,Y0,X1,Y1");
    expect_kept_error("glass=0,0,8\n", "1", "bad region '0,0,8'");
    expect_kept_error("image=0,0,8,8\n", "1", "other than image");
    expect_kept_error("\nglass=0,0,65,48\n", "2", "is not inside the scene's 64x48 image");
    expect_kept_error("glass=0,0,8,8\nglass=1,1,8,8\n", "2", "region glass comes twice");
}

} // namespace
} // namespace tristim::test
