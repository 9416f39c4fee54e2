// Disks that are full: file systems of 64 KiB in memory, in a namespace of their own. tests/resume_command_test.cpp has
// limits on the size of files in their place, which every machine allows.

#include "checkpoint_renders.h"
#include "child_process.h"

#include <sstream>

namespace tristim::test {
namespace {

constexpr int no_such_file_system = 77;

class FullDisk : public testing::Test {
  protected:
    /// Runs a shell script where $disk is an empty disk of 64 KiB, $out a folder that stays, and $tristim the command;
    /// `fill` leaves no room on the disk, `run NAME ARGUMENTS…` leaves NAME.status and NAME.stderr in $out.
    void run(const std::string& script) {
        const std::string before = R"(
            mount -t tmpfs -o size=64k none "$disk" || exit 77
            fill() { head -c 100000 /dev/zero > "$disk/fill" 2> /dev/null; }
            run() { name=$1; shift; "$tristim" "$@" 2> "$out/$name.stderr"; echo $? > "$out/$name.status"; }
            render() { name=$1; shift; run $name render "$out/scene.pbrt" --photons 1024 --space xyz --quiet "$@"; }
            )";
        std::filesystem::create_directory(path("disk"));
        const ChildResult result =
            run_program("/usr/bin/env", {"unshare", "-Urm", "sh", "-c", before + script},
                        {{"disk", path("disk")}, {"out", path("")}, {"tristim", TRISTIM_COMMAND}});
        // 127 and 1: there is no unshare, or it may not.
        if (result.exit_code == no_such_file_system || result.exit_code == 127 || result.exit_code == 1)
            GTEST_SKIP() << "no file system of one's own may be mounted here: " << result.standard_error;
        ASSERT_EQ(result.exit_code, 0) << result.standard_error;
    }

    std::string path(const std::string& name) const { return renders.path(name); }

    void expect(const std::string& name, int status, const std::string& message) const {
        EXPECT_EQ(read_text(path(name + ".status")), fmt::format("{}\n", status)) << name;
        EXPECT_EQ(read_text(path(name + ".stderr")), message) << name;
    }

    const CheckpointRenders renders;
};

TEST_F(FullDisk, ARenderKeepsTheOldCheckpointAndGoesOnOnceThereIsRoom) {
    renders.render({path("begun.exr"), {}, {}}, {3, {}});
    run(R"(
        cp "$out/begun.exr" "$disk/a.exr"
        fill
        render full --passes 6 --resume "$disk/a.exr" --every 1000 --outfile "$out/image.exr"
        ls -A "$disk" > "$out/files"
        cp "$disk/a.exr" "$out/kept.exr"
        rm "$disk/fill"
        render on --passes 6 --resume "$disk/a.exr" --outfile "$out/image.exr"
        cp "$disk/a.exr" "$out/whole.exr")");
    if (IsSkipped())
        return;
    expect("full", 1,
           fmt::format("warning: no checkpoint of 6 passes: cannot write \"{}\": No space left on device; that of 3 "
                       "passes is still there\n",
                       path("disk/a.exr")));
    EXPECT_EQ(read_text(path("files")), "a.exr\nfill\n");
    EXPECT_EQ(read_text(path("kept.exr")), read_text(path("begun.exr")));
    expect("on", 0, "");
    EXPECT_TRUE(same_bytes(read_checkpoint(path("whole.exr")).sums.film, renders.render({}, {6, {}}).film));
}

TEST_F(FullDisk, ImagesAndMergedFilesAreWholeOrNotThere) {
    renders.render({path("a.exr"), {}, {}}, {3, {}});
    run(R"(
        echo old > "$disk/image.exr"
        fill
        render image --passes 3 --outfile "$disk/image.exr" --outfile "$out/image.png" --checkpoint "$out/b.exr"
        run sums merge "$out/a.exr" --checkpoint "$disk/sums.exr" --outfile "$out/sums.png"
        run merged merge "$out/a.exr" --outfile "$disk/merged.png" --outfile "$out/merged.png"
        cp "$disk/image.exr" "$out/old"
        ls -A "$disk" > "$out/files")");
    if (IsSkipped())
        return;
    const auto message = [&](const std::string& file) {
        return fmt::format("tristim: cannot write \"{}\": No space left on device\n", path("disk/" + file));
    };
    expect("image", 1, message("image.exr"));
    expect("sums", 1, message("sums.exr"));
    expect("merged", 1, message("merged.png"));
    EXPECT_EQ(read_text(path("files")), "fill\nimage.exr\n");
    EXPECT_EQ(read_text(path("old")), "old\n");
    // What was to go elsewhere is there.
    EXPECT_EQ(read_checkpoint(path("b.exr")).sums.passes, PassRanges(0, 3));
    EXPECT_TRUE(std::filesystem::exists(path("image.png")));
    EXPECT_TRUE(std::filesystem::exists(path("merged.png")));
}

} // namespace
} // namespace tristim::test
