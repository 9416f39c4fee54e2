// Renders that are stopped, killed or run out of disk, and go on: `render --checkpoint` and `--resume`.

#include "checkpoint_renders.h"
#include "child_process.h"
#include "image/read_image.h"

#include <OpenImageIO/imageio.h>

#include <csignal>
#include <random>
#include <sys/resource.h>
#include <thread>
#include <utility>

namespace tristim::test {
namespace {

class ResumeCommand : public testing::Test {
  protected:
    std::string path(const std::string& name) const { return renders.path(name); }

    void expect_no_temporary_files() const {
        for (const auto& entry : std::filesystem::directory_iterator(path("")))
            EXPECT_EQ(entry.path().filename().string().find(".tmp"), std::string::npos) << entry.path();
    }

    const CheckpointRenders renders;
};

/// Renders by one device come to the same bits, squares and counts included.
void expect_same_sums(const RenderSums& a, const RenderSums& b) {
    EXPECT_EQ(a.passes, b.passes);
    EXPECT_TRUE(same_bytes(a.film, b.film));
    EXPECT_EQ(a.rays.camera, b.rays.camera);
    EXPECT_EQ(a.rays.shadow, b.rays.shadow);
    EXPECT_EQ(a.rays.photon, b.rays.photon);
    EXPECT_EQ(a.photons_stored, b.photons_stored);
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
        const ChildResult result = run_tristim(
            renders.command({"--passes=1000000", "--checkpoint", checkpoint, "--resume", checkpoint, "--every=0.001"}),
            {}, limits);
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
    const std::uint64_t passes = saved.count() + 5;
    const ChildResult last =
        run_tristim(renders.command({fmt::format("--passes={}", passes), "--resume", checkpoint, "--quiet"}));
    ASSERT_EQ(last.exit_code, 0) << last.standard_error;
    expect_no_temporary_files();
    const RenderSums whole = renders.render({}, {passes, {}});
    expect_same_sums(read_checkpoint(checkpoint).sums, whole);
    EXPECT_EQ(passes_in(path("image.exr")), static_cast<std::int64_t>(passes));
    EXPECT_TRUE(same_bytes(read_exr(path("image.exr")).xyz, developed(whole, renders.options()).xyz));
}

/// A scheduler takes the machine away.
TEST_F(ResumeCommand, TerminatedAllIsSaved) {
    ChildLimits limits;
    limits.interrupt_signal = SIGTERM;
    limits.interrupt_after = std::chrono::milliseconds(50);
    const ChildResult stopped = run_tristim(renders.command({"--time=300", "--checkpoint", path("a.exr")}), {}, limits);
    EXPECT_EQ(stopped.exit_code, 3) << stopped.standard_error;
    EXPECT_NE(stopped.standard_error.find("interrupted: "), std::string::npos) << stopped.standard_error;
    const Checkpoint saved = read_checkpoint(path("a.exr"));
    EXPECT_FALSE(saved.sums.passes.empty());
    EXPECT_EQ(passes_in(path("image.exr")), static_cast<std::int64_t>(saved.sums.passes.count()));
    EXPECT_GT(saved.seconds, 0.0);
}

/// A signal before anything is rendered. It makes the compiler of kernels fail at times, as that does here.
TEST_F(ResumeCommand, TerminatedDuringSetUpIsNoOtherFailure) {
    const std::string checkpoint = path("a.exr");
    renders.render({checkpoint, {}, {}}, {3, {}});
    const std::string before = read_text(checkpoint);
    ChildLimits limits;
    limits.pending_signal = SIGTERM;
    const std::vector<std::string> command = renders.command({"--passes=1000000", "--resume", checkpoint, "--quiet"});
    const ChildResult failed = run_tristim(command, {{"TRISTIM_FAULT", "build:1"}}, limits);
    EXPECT_EQ(failed.exit_code, 1);
    EXPECT_EQ(failed.standard_error, "tristim: interrupted before the first pass was done: no image written\n");
    EXPECT_EQ(read_text(checkpoint), before);
    // What was resumed makes an image anyway.
    const ChildResult stopped = run_tristim(command, {}, limits);
    EXPECT_EQ(stopped.exit_code, 3) << stopped.standard_error;
    EXPECT_GE(passes_in(path("image.exr")), 3);
}

/// The folder goes away: the render goes on, writes its image, and says so by its exit status.
TEST_F(ResumeCommand, WhereTheLastCheckpointCannotBeWrittenTheStatusTells) {
    const std::string folder = path("checkpoints"), checkpoint = folder + "/a.exr";
    std::filesystem::create_directory(folder);
    std::jthread remover([&](const std::stop_token& stop) {
        while (!std::filesystem::exists(checkpoint) && !stop.stop_requested())
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        while (std::filesystem::exists(folder)) { // the render may be writing into it
            std::error_code again;
            std::filesystem::remove_all(folder, again);
        }
    });
    const ChildResult result =
        run_tristim(renders.command({"--time=0.4", "--checkpoint", checkpoint, "--every=0.001", "--quiet"}));
    remover.request_stop();
    EXPECT_EQ(result.exit_code, 1) << result.standard_error;
    EXPECT_NE(result.standard_error.find("warning: no checkpoint of"), std::string::npos) << result.standard_error;
    EXPECT_GE(passes_in(path("image.exr")), 1);
}

/// A disk that is full for a while: what was saved stays as it is, and later on saving works again.
TEST_F(ResumeCommand, OnAFullDiskTheOldCheckpointStays) {
    const std::string checkpoint = path("a.exr");
    renders.render({checkpoint, {}, {}}, {3, {}});
    const std::string before = read_text(checkpoint);
    rlimit unlimited{};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &unlimited), 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    int seen = 0;
    testing::internal::CaptureStderr();
    const RenderSums sums = renders.render({{}, checkpoint, 1e-6}, {8, {}}, [&] {
        if (seen++ == 0) {
            const rlimit full{before.size() / 2, unlimited.rlim_max};
            ::setrlimit(RLIMIT_FSIZE, &full);
        }
    });
    ::setrlimit(RLIMIT_FSIZE, &unlimited);
    std::signal(SIGXFSZ, handler);
    const std::string told = testing::internal::GetCapturedStderr();
    EXPECT_NE(told.find("warning: no checkpoint of 8 passes: cannot write \"" + checkpoint +
                        "\": File too large; that of 3 passes is still there\n"),
              std::string::npos)
        << told;
    EXPECT_EQ(read_text(checkpoint), before);
    expect_no_temporary_files();
    EXPECT_EQ(sums.passes, PassRanges(0, 8));
    expect_same_sums(renders.render({{}, checkpoint, {}}, {8, {}}), sums);
    expect_same_sums(read_checkpoint(checkpoint).sums, sums);
}

TEST_F(ResumeCommand, WhatCannotBeResumedIsRefused) {
    const std::string checkpoint = path("a.exr");
    ASSERT_EQ(renders.render({checkpoint, {}, {}}, {2, {}, 2}).passes, PassRanges(2, 4));
    const std::string before = read_text(checkpoint);
    const auto refused = [&](const CheckpointArguments& arguments, const std::string& words) {
        const std::string message = error_of([&] { renders.render(arguments, {9, {}}); });
        EXPECT_NE(message.find(words), std::string::npos) << message;
        EXPECT_EQ(read_text(checkpoint), before);
    };
    refused({checkpoint, {}, {}}, "is there already: go on from it by render --resume");
    refused({{}, path("none.exr"), {}}, "none.exr");
    refused({{}, renders.folder().write("cut.exr", before.substr(0, before.size() / 2)), {}}, "damaged");
    refused({path("cut.exr"), checkpoint, {}}, "is there already");
    refused({{}, {}, 5.0}, "--every needs --checkpoint");
    refused({path("b.exr"), {}, 0.0}, "--every must be a positive number");
    refused({path("none/a.exr"), {}, {}}, "does not exist");
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"--resume", checkpoint, "--method=hero:4"},
          std::vector<std::string>{"--passes=1", "--outfile", checkpoint}}) {
        const ChildResult result = run_tristim(renders.command(arguments));
        EXPECT_EQ(result.exit_code, 1) << result.standard_error;
        const std::string words =
            arguments.front() == "--resume"
                ? "cannot resume \"" + checkpoint + "\": it was rendered with method tristimulus:1, not hero:4\n"
                : "cannot write an image to \"" + checkpoint + "\": a checkpoint is there";
        EXPECT_NE(result.standard_error.find(words), std::string::npos) << result.standard_error;
        EXPECT_EQ(read_text(checkpoint), before);
    }
    EXPECT_FALSE(std::filesystem::exists(path("image.exr")));
    // The file to resume may be missing where it is the one that will be written, and then every pass is rendered.
    EXPECT_EQ(renders.render({path("new.exr"), path("new.exr"), {}}, {2, {}}).passes, PassRanges(0, 2));
    EXPECT_EQ(renders.render({path("new.exr"), path("new.exr"), {}}, {3, {}}).passes, PassRanges(0, 3));
    EXPECT_EQ(read_checkpoint(path("new.exr")).sums.passes, PassRanges(0, 3));
}

/// By whatever name: nothing replaces a checkpoint but the render that goes on from it.
TEST_F(ResumeCommand, NoOtherFileTakesTheCheckpointsPlace) {
    const std::string checkpoint = path("a.exr"), alias = path("./a.exr");
    const auto refused = [&](const std::vector<std::string>& arguments, int status, const std::string& words) {
        const ChildResult result = run_tristim(renders.command(arguments));
        EXPECT_EQ(result.exit_code, status) << words;
        EXPECT_NE(result.standard_error.find(words), std::string::npos) << result.standard_error;
        EXPECT_FALSE(std::filesystem::exists(path("image.exr")));
    };
    refused({"--checkpoint", checkpoint, "--outfile", alias}, 1, "cannot write an image to \"" + alias);
    refused({"--checkpoint", checkpoint, "--stats", alias}, 1, "cannot write statistics to \"" + alias);
    refused({"--stats", path("./image.exr")}, 1, "an image will be there");
    EXPECT_FALSE(std::filesystem::exists(checkpoint));
    // A script's variable that was never set.
    refused({"--checkpoint", ""}, 2, "--checkpoint: its value is empty");
    refused({"--resume", ""}, 2, "--resume: its value is empty");
    refused({"--pass-range", ""}, 2, "--pass-range: its value is empty");
}

/// Two renders with one command line, such as a job that a scheduler starts again while the first still runs.
TEST_F(ResumeCommand, WhatAnotherProcessHasSavedMeanwhileStays) {
    const std::string checkpoint = path("a.exr");
    for (const std::uint64_t begun : {0U, 2U}) {
        if (begun > 0)
            renders.render({checkpoint, checkpoint, {}}, {begun, {}});
        bool other_done = false;
        testing::internal::CaptureStderr();
        const RenderSums sums = renders.render({checkpoint, checkpoint, {}}, {begun + 3, {}}, [&] {
            if (!std::exchange(other_done, true))
                renders.render({checkpoint, checkpoint, {}}, {begun + 9, {}});
        });
        const std::string told = testing::internal::GetCapturedStderr();
        EXPECT_EQ(told,
                  fmt::format("warning: no checkpoint of {} passes: another process has written \"{}\" meanwhile, "
                              "and what it saved stays there\n",
                              begun + 3, checkpoint));
        EXPECT_EQ(sums.passes.count(), begun + 3);
        EXPECT_EQ(read_checkpoint(checkpoint).sums.passes.count(), begun + 9);
        std::filesystem::remove(checkpoint);
    }
}

} // namespace
} // namespace tristim::test
