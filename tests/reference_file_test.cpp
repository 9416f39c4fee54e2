// A reference's file: what is written comes back, and nothing else than a sound reference of the right scene is taken.
#include "bench/reference_file.h"
#include "image/read_image.h"
#include "scene_folder.h"

#include <cmath>
#include <functional>
#include <limits>

namespace tristim::test::reference_files_test {
namespace {

using Pixels = std::vector<std::array<float, 3>>;

Pixels pixels(float first) {
    Pixels values(6);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = {first + static_cast<float>(i), first * 0.1F, first / 3.0F};
    return values;
}

/// Part of an image, with more photons than 32 bits count.
Reference sound_reference() {
    Reference r;
    r.image = {8, 5, {2, 1, 3, 2}, pixels(1.0F)};
    r.variance = pixels(0.01F);
    r.halves[0] = {70000, pixels(0.9F), pixels(0.8F)};
    r.halves[1] = {69968, pixels(1.1F), pixels(1.2F)};
    r.snapshot_passes = 8192;
    r.scene = "scenes/a.pbrt";
    r.method = "spectral:400";
    r.passes = 139968;
    r.photons = 139968ULL * 65536ULL;
    r.seconds = 1234.5678901234;
    r.seed = 0xfffffff0U;
    r.rejected_samples = 3;
    r.identity = {"0123456789abcdef", "fedcba9876543210", 8, 5, r.image.region, 16};
    RenderOptions options;
    options.photons_per_pass = 65536;
    options.radius = 0.1;
    r.settings = reference_settings(options);
    return r;
}

class ReferenceFile : public testing::Test {
  protected:
    ReferenceFile() : path(folder.path("r.exr")) {}

    /// The message of reading a reference in which something was changed before it was written.
    std::string error_after(const std::function<void(Reference&)>& change) const {
        Reference reference = sound_reference();
        change(reference);
        write_reference(path, reference, {});
        return error_of([this] { read_reference(path); });
    }

    SceneFolder folder;
    std::string path;
};

TEST_F(ReferenceFile, ComesBackAsItWas) {
    const Reference r = sound_reference();
    write_reference(path, r, {{"device", std::string("a device")}, {"passes", std::int64_t{1}}});
    const Reference back = read_reference(path);
    EXPECT_EQ(back.image.full_width, r.image.full_width);
    EXPECT_EQ(back.image.full_height, r.image.full_height);
    EXPECT_EQ(back.image.region, r.image.region);
    EXPECT_EQ(back.image.xyz, r.image.xyz);
    EXPECT_EQ(back.variance, r.variance);
    for (std::size_t h = 0; h < 2; ++h) {
        EXPECT_EQ(back.halves[h].passes, r.halves[h].passes);
        EXPECT_EQ(back.halves[h].xyz, r.halves[h].xyz);
        EXPECT_EQ(back.halves[h].snapshot, r.halves[h].snapshot);
    }
    EXPECT_EQ(back.snapshot_passes, r.snapshot_passes);
    EXPECT_EQ(back.scene, r.scene);
    EXPECT_EQ(back.method, r.method);
    EXPECT_EQ(back.passes, r.passes);
    EXPECT_EQ(back.photons, r.photons);
    EXPECT_EQ(back.seconds, r.seconds);
    EXPECT_EQ(back.seed, r.seed);
    EXPECT_EQ(back.rejected_samples, r.rejected_samples);
    EXPECT_EQ(back.identity, r.identity);
    EXPECT_EQ(back.settings, r.settings);
    check_reference(back, path, r.identity);

    // It is an image like others, too, and what the caller says of the render is kept.
    EXPECT_EQ(read_exr(path).xyz, r.image.xyz);
    const ImageMetadata metadata = read_layered_exr(path).metadata;
    const ImageMetadata::value_type device{"device", std::string("a device")};
    EXPECT_NE(std::find(metadata.begin(), metadata.end(), device), metadata.end());
}

TEST_F(ReferenceFile, WithoutSnapshotsAsWell) {
    Reference r = sound_reference();
    r.snapshot_passes = 0;
    for (ReferenceHalf& half : r.halves)
        half.snapshot.clear();
    write_reference(path, r, {});
    const Reference back = read_reference(path);
    EXPECT_EQ(back.snapshot_passes, 0U);
    EXPECT_TRUE(back.halves[1].snapshot.empty());
    EXPECT_EQ(back.halves[1].xyz, r.halves[1].xyz);
}

TEST_F(ReferenceFile, RefusesWhatIsNoReference) {
    expect_message(error_of([this] { read_reference(path); }), "cannot read \"" + path + "\": ", "No such file");
    folder.write("r.exr", "not an image");
    expect_message(error_of([this] { read_reference(path); }), "cannot read \"" + path + "\"", "OpenEXR");
    write_exr(path, sound_reference().image, ColourSpace::CieXyz, {{"method", std::string("rgb")}});
    expect_message(error_of([this] { read_reference(path); }),
                   "cannot use \"" + path + "\" as a reference: ", "not written by tristim reference");
    write_exr(path, sound_reference().image, ColourSpace::CieXyz, {{"reference", std::int64_t{2}}});
    expect_message(error_of([this] { read_reference(path); }),
                   "cannot use \"" + path + "\" as a reference: ", "another version");
}

TEST_F(ReferenceFile, RefusesDamage) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    const std::string start = "cannot use \"" + path + "\"";
    expect_message(error_after([](Reference& r) { r.image.xyz[4][1] = nan; }), start,
                   "1 of its 6 pixels are infinite or not a number, the first at x = 3, y = 2");
    expect_message(error_after([](Reference& r) { r.variance[0][0] = nan; }), start, "x = 2, y = 1");
    expect_message(error_after([](Reference& r) { r.halves[1].xyz[5][2] = nan; }), start, "x = 4, y = 2");
    expect_message(error_after([](Reference& r) { r.halves[0].snapshot[5][2] = INFINITY; }), start, "x = 4, y = 2");
    expect_message(error_after([](Reference& r) { r.seconds = std::nan(""); }), start, "\"seconds_rendering\"");
    expect_message(error_after([](Reference& r) { r.passes = 0; }), start, "\"passes\"");
    expect_message(error_after([](Reference& r) { r.halves[0].passes = 139969; }), start, "\"half1_passes\"");
    expect_message(error_after([](Reference& r) { r.snapshot_passes = 69968; }), start, "\"snapshot_passes\"");
    expect_message(error_after([](Reference& r) { r.settings.pop_back(); }), start, "\"math\"");

    // A file that a full disk or a broken copy left behind, cut anywhere.
    write_reference(path, sound_reference(), {});
    const auto size = std::filesystem::file_size(path);
    for (const std::uintmax_t cut : {size - 1, size * 3 / 4, size / 2, std::uintmax_t{100}, std::uintmax_t{0}}) {
        write_reference(path, sound_reference(), {});
        std::filesystem::resize_file(path, cut);
        expect_message(error_of([this] { read_reference(path); }), "cannot read \"" + path + "\"", "");
    }
}

TEST_F(ReferenceFile, RefusesAnotherScene) {
    const Reference r = sound_reference();
    const auto difference = [&](const std::function<void(SceneIdentity&)>& change) {
        SceneIdentity wanted = r.identity;
        change(wanted);
        const std::string message = error_of([&] { check_reference(r, "r.exr", wanted); });
        const std::string start = "cannot use \"r.exr\" as a reference: ";
        expect_message(message, start, "");
        return message.substr(std::min(start.size(), message.size()));
    };
    EXPECT_EQ(difference([](SceneIdentity& wanted) { wanted.scene[3] = 'f'; }),
              "it shows another scene (rendered from \"scenes/a.pbrt\"; its geometry, materials or lights differ)");
    EXPECT_EQ(difference([](SceneIdentity& wanted) { wanted.camera[3] = 'f'; }), "its camera is another one");
    EXPECT_EQ(difference([](SceneIdentity& wanted) { wanted.height = 6; }), "its resolution is 8x5, not 8x6");
    EXPECT_EQ(difference([](SceneIdentity& wanted) {
                  wanted.region = {0, 0, 8, 5};
              }),
              "its region is 2,1,5,3, not 0,0,8,5");
    EXPECT_EQ(difference([](SceneIdentity& wanted) { wanted.max_depth = 8; }), "its maximum depth is 16, not 8");
    // A pixel's size is part of the camera's hash, so that another resolution says nothing of the camera.
    EXPECT_EQ(difference([](SceneIdentity& wanted) {
                  wanted = {wanted.scene, "other camera", 16, 10, {0, 0, 16, 10}, 8};
              }),
              "its resolution is 8x5, not 16x10; its maximum depth is 16, not 8");

    Reference one_pass = r;
    one_pass.halves[1].passes = 0;
    expect_message(error_of([&] { check_reference(one_pass, "r.exr", r.identity); }),
                   "cannot use \"r.exr\" as a reference: ", "one pass");
}

} // namespace
} // namespace tristim::test::reference_files_test
