// `tristim merge`: passes of one image that were rendered apart.

#include "checkpoint_renders.h"
#include "child_process.h"
#include "image/read_image.h"

#include <OpenImageIO/imageio.h>

namespace tristim::test {
namespace {

TEST(MergeCommand, ARenderInPiecesIsTheWholeImage) {
    const CheckpointRenders renders;
    const auto path = [&](const std::string& name) { return renders.path(name); };
    renders.render({path("a.exr"), {}, {}}, {3, {}});
    const ChildResult piece =
        run_tristim(renders.command({"--pass-range=5:9", "--checkpoint", path("c.exr"), "--quiet"}));
    EXPECT_EQ(piece.exit_code, 0) << piece.standard_error;
    const ChildResult merged = run_tristim({"merge", path("c.exr"), path("a.exr"), "--checkpoint", path("ac.exr"),
                                            "--outfile", path("ac-image.exr"), "--outfile", path("ac.png")});
    EXPECT_EQ(merged.exit_code, 0) << merged.standard_error;
    EXPECT_EQ(merged.standard_error.find("7 passes (0:3,5:9); noise at most "), 0U) << merged.standard_error;
    EXPECT_NE(merged.standard_error.find("; 0 non-finite values\n"), std::string::npos) << merged.standard_error;
    EXPECT_TRUE(std::filesystem::exists(path("ac.png")));
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path("ac-image.exr"));
    ASSERT_TRUE(input) << OIIO::geterror();
    EXPECT_EQ(input->spec().get_int_attribute("tristim:passes"), 7);
    EXPECT_EQ(input->spec().get_int_attribute("tristim:photons"), 7 * 1024);
    EXPECT_EQ(input->spec().get_string_attribute("tristim:pass_ranges"), "0:3,5:9");
    EXPECT_EQ(input->spec().get_string_attribute("tristim:method"), "tristimulus:1");

    // A resumed render fills the gap and goes on.
    const RenderSums filled = renders.render({{}, path("ac.exr"), {}}, {10, {}});
    const RenderSums whole = renders.render({}, {10, {}});
    EXPECT_EQ(filled.passes, whole.passes);
    EXPECT_EQ(filled.rays.photon, whole.rays.photon);
    EXPECT_EQ(filled.rays.camera, whole.rays.camera);
    EXPECT_EQ(filled.photons_stored, whole.photons_stored);
    EXPECT_TRUE(same_bytes(developed(filled, renders.options()).xyz, developed(whole, renders.options()).xyz));

    const auto refused = [&](std::vector<std::string> arguments, const std::string& words) {
        arguments.insert(arguments.begin(), "merge");
        const ChildResult result = run_tristim(arguments);
        EXPECT_EQ(result.exit_code, 1) << words;
        EXPECT_NE(result.standard_error.find(words), std::string::npos) << result.standard_error;
        EXPECT_FALSE(std::filesystem::exists(path("no.exr")));
    };
    refused({path("c.exr"), path("a.exr"), path("a.exr"), "--outfile", path("no.exr")}, "both hold the passes 0:3");
    refused({path("a.exr"), "--checkpoint", path("c.exr")}, "is there already");
    refused({path("a.exr"), "--checkpoint", path("no.exr"), "--outfile", path("./no.exr")}, "a checkpoint is there");
    refused({path("a.exr"), "--checkpoint", path("no.exr"), "--outfile", path("i.exr"), "--aov=error"}, "--aov error");
}

/// Renders with and without the sums that errors are estimated from.
TEST(MergeCommand, WhereSomeTellNoErrorTheWholeDoesNot) {
    const CheckpointRenders renders;
    const std::string with = renders.path("with.exr"), without = renders.path("without.exr");
    renders.render({without, {}, {}}, {3, {}, 20});
    ASSERT_EQ(run_tristim(renders.command({"--passes=16", "--checkpoint", with, "--aov=error", "--quiet"})).exit_code,
              0);
    for (const auto& [first, second] : {std::pair(with, without), std::pair(without, with)}) {
        const ChildResult merged =
            run_tristim({"merge", first, second, "--outfile", renders.path("all.png"), "--quiet"});
        EXPECT_EQ(merged.exit_code, 0);
        EXPECT_NE(merged.standard_error.find("warning: the error of all passes cannot be estimated"), std::string::npos)
            << merged.standard_error;
        EXPECT_NE(merged.standard_error.find(": " + without + "\n"), std::string::npos) << merged.standard_error;
    }
}

/// A limit on the size of files ends no process halfway through a file.
TEST(MergeCommand, AFileThatMustNotGrowIsNotThere) {
    const CheckpointRenders renders;
    renders.render({renders.path("a.exr"), {}, {}}, {1, {}});
    const std::string out = renders.path("out");
    std::filesystem::create_directory(out);
    const ChildResult result = run_program("/bin/sh", {"-c", "ulimit -f 1; exec \"$@\"", "sh", TRISTIM_COMMAND, "merge",
                                                       renders.path("a.exr"), "--checkpoint", out + "/b.exr"});
    EXPECT_EQ(result.exit_code, 1) << result.standard_error;
    EXPECT_EQ(result.standard_error, "tristim: cannot write \"" + out + "/b.exr\": File too large\n");
    EXPECT_TRUE(std::filesystem::is_empty(out));
}

} // namespace
} // namespace tristim::test
