// Renders that are stopped, killed or run out of disk, and go on: `render --checkpoint` and `--resume`.

#include "child_process.h"
#include "image/read_image.h"
#include "render/checkpoint.h"
#include "scene_folder.h"
#include "test_scenes.h"

#include <OpenImageIO/imageio.h>

#include <cstring>
#include <random>

namespace tristim::test {
namespace {

constexpr const char* scene_text = "Camera \"perspective\"\n"
                                   "Film \"rgb\" \"integer xresolution\" [ 8 ] \"integer yresolution\" [ 6 ]\n"
                                   "WorldBegin\n"
                                   "LightSource \"point\" \"point3 from\" [ 0 1 0 ] \"spectrum I\" \"stdillum-A\"\n"
                                   "Material \"diffuse\" \"rgb reflectance\" [ 0.7 0.3 0.1 ]\n"
                                   "Shape \"bilinearmesh\" \"point3 P\" [ -20 -20 5  20 -20 5  -20 20 5  20 20 5 ]\n";

class ResumeCommand : public testing::Test {
  protected:
    /// The image goes to image.exr.
    ChildResult render(std::vector<std::string> more, const ChildLimits& limits = {}) const {
        more.insert(more.begin(), {"render", scene_, "--photons=256", "--space=xyz", "--outfile", image_});
        return run_tristim(more, {}, limits);
    }

    std::string path(const std::string& name) const { return folder_.path(name); }

    void expect_no_temporary_files() const {
        for (const auto& entry : std::filesystem::directory_iterator(path("")))
            EXPECT_EQ(entry.path().filename().string().find(".tmp"), std::string::npos) << entry.path();
    }

    const SceneFolder folder_;
    const std::string scene_ = folder_.write("scene.pbrt", scene_text);
    const std::string image_ = folder_.path("image.exr");
};

template <typename T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

/// Sums, counts and radii of two renders by one device.
void expect_same_sums(const Checkpoint& a, const Checkpoint& b) {
    EXPECT_EQ(a.sums.passes, b.sums.passes);
    EXPECT_TRUE(same_bytes(a.sums.film, b.sums.film));
    EXPECT_TRUE(same_bytes(a.initial_radii, b.initial_radii));
    EXPECT_EQ(a.sums.rays.camera, b.sums.rays.camera);
    EXPECT_EQ(a.sums.rays.shadow, b.sums.rays.shadow);
    EXPECT_EQ(a.sums.rays.photon, b.sums.rays.photon);
    EXPECT_EQ(a.sums.photons_stored, b.sums.photons_stored);
    EXPECT_EQ(a.identity, b.identity);
}

std::size_t words_in(const std::string& text, const std::string& words) {
    std::size_t count = 0;
    for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1))
        ++count;
    return count;
}

std::int64_t passes_in(const std::string& image) {
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(image);
    return input ? input->spec().get_int_attribute("tristim:passes") : -1;
}

/// Killed at random moments and resumed each time, a render comes to what it would have come to in one go; whatever was
/// in the checkpoint once stays in it.
TEST_F(ResumeCommand, KilledAnywhereNothingSavedIsLost) {
    const int kills = long_tests() ? 100 : 3;
    const std::string checkpoint = path("killed.exr");
    std::mt19937 random(1);
    PassRanges saved;
    int with_progress = 0;
    for (int kill = 0; kill < kills; ++kill) {
        ChildLimits limits;
        limits.interrupt_signal = SIGKILL;
        limits.interrupt_after = std::chrono::milliseconds(random() % 120);
        const ChildResult result =
            render({"--passes=1000000", "--checkpoint", checkpoint, "--resume", checkpoint, "--every=0.001"}, limits);
        ASSERT_EQ(result.exit_code, 128 + SIGKILL) << result.standard_error;
        if (!std::filesystem::exists(checkpoint))
            continue;
        const PassRanges now = read_checkpoint(checkpoint).sums.passes;
        EXPECT_EQ(now.common(saved), saved);
        EXPECT_EQ(now, PassRanges(0, static_cast<std::uint32_t>(now.count())));
        with_progress += now.count() > saved.count() ? 1 : 0;
        saved = now;
    }
    EXPECT_GT(with_progress, 0);
    const std::string passes = fmt::format("--passes={}", saved.count() + 5);
    ASSERT_EQ(render({passes, "--resume", checkpoint, "--quiet"}).exit_code, 0);
    const XyzImage resumed = read_exr(image_);
    ASSERT_EQ(render({passes, "--checkpoint", path("whole.exr"), "--quiet"}).exit_code, 0);
    expect_same_sums(read_checkpoint(checkpoint), read_checkpoint(path("whole.exr")));
    EXPECT_TRUE(same_bytes(resumed.xyz, read_exr(image_).xyz));
    EXPECT_EQ(passes_in(image_), static_cast<std::int64_t>(saved.count() + 5));
    expect_no_temporary_files();
}

/// A scheduler takes the machine away; then the disk is full.
TEST_F(ResumeCommand, TerminatedAllIsSavedAndOnAFullDiskTheOldStays) {
    const std::string checkpoint = path("a.exr");
    ChildLimits limits;
    limits.interrupt_signal = SIGTERM;
    limits.interrupt_after = std::chrono::milliseconds(50);
    const ChildResult stopped = render({"--resolution=32x24", "--time=300", "--checkpoint", checkpoint}, limits);
    EXPECT_EQ(stopped.exit_code, 3) << stopped.standard_error;
    EXPECT_NE(stopped.standard_error.find("interrupted: "), std::string::npos) << stopped.standard_error;
    const PassRanges passes = read_checkpoint(checkpoint).sums.passes;
    EXPECT_FALSE(passes.empty());
    EXPECT_EQ(passes_in(image_), static_cast<std::int64_t>(passes.count()));

    limits.file_size_then = std::filesystem::file_size(checkpoint) / 2;
    limits.interrupt_after = std::chrono::milliseconds(200);
    const ChildResult full = render(
        {"--resolution=32x24", "--time=300", "--resume", checkpoint, "--every=0.05", "--outfile", path("image.png")},
        limits);
    EXPECT_EQ(full.exit_code, 1) << full.standard_error;
    const PassRanges kept = read_checkpoint(checkpoint).sums.passes;
    EXPECT_EQ(kept.common(passes), passes);
    const std::string still = fmt::format("File too large; that of {} passes is still there\n", kept.count());
    EXPECT_GE(words_in(full.standard_error, still), 2U) << full.standard_error;
    EXPECT_TRUE(std::filesystem::exists(path("image.png")));
    expect_no_temporary_files();
}

TEST_F(ResumeCommand, WhatCannotBeResumedIsRefused) {
    const std::string checkpoint = path("a.exr");
    ASSERT_EQ(render({"--pass-range=2:4", "--checkpoint", checkpoint, "--quiet"}).exit_code, 0);
    const std::string before = read_text(checkpoint);
    const auto refused = [&](const std::vector<std::string>& arguments, const std::string& words) {
        const ChildResult result = render(arguments);
        EXPECT_EQ(result.exit_code, 1) << words;
        EXPECT_NE(result.standard_error.find(words), std::string::npos) << result.standard_error;
        EXPECT_EQ(read_text(checkpoint), before);
    };
    refused({"--resume", checkpoint, "--method=hero:4"},
            "cannot resume \"" + checkpoint + "\": it was rendered with method tristimulus:1, not hero:4");
    refused({"--checkpoint", checkpoint}, "is there already: go on from it by render --resume");
    refused({"--resume", path("none.exr")}, "none.exr");
    refused({"--resume", image_}, "it was not written by tristim's --checkpoint");
    refused({"--resume", folder_.write("cut.exr", before.substr(0, before.size() / 2))}, "damaged");
    refused({"--outfile", checkpoint}, "cannot write an image to");
    refused({"--outfile", path("b.exr"), "--checkpoint", path("b.exr")}, "cannot write an image to");
    refused({"--every=5"}, "--every needs --checkpoint");
    refused({"--pass-range=5:5"}, "bad range of passes '5:5'");
    refused({"--checkpoint", path("none/a.exr")}, "does not exist");
    EXPECT_FALSE(std::filesystem::exists(path("none.exr")));
}

} // namespace
} // namespace tristim::test
