// --method auto on the command line and in benches.
#include "bench_folder.h"
#include "child_process.h"
#include "scene_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace tristim::test {
namespace {

using BenchRun = tristim::Run; // testing::Test has a Run too

class AutoCommand : public testing::Test {
  protected:
    void SetUp() override { folder_.write("tiny.pbrt", tiny_scene()); }
    std::string path(const std::string& name) const { return folder_.path(name); }

    SceneFolder folder_;
};

TEST_F(AutoCommand, RenderSaysWhatItChoseAndTheImageToo) {
    const auto result = run_tristim({"render", path("tiny.pbrt"), "--method", "auto", "--passes", "3", "--outfile",
                                     path("a.exr"), "--stats", path("a.json")});
    ASSERT_EQ(result.exit_code, 0) << result.standard_error;
    const std::string method = read_json(path("a.json"))["method"];
    EXPECT_TRUE(parse_method(method).unbiased());
    EXPECT_NE(result.standard_error.find("auto: chose " + method), std::string::npos) << result.standard_error;

    // The method by its own name gives the same image.
    ASSERT_EQ(run_tristim({"render", path("tiny.pbrt"), "--method", method, "--passes", "3", "--outfile", path("b.exr"),
                           "--quiet"})
                  .exit_code,
              0);
    const auto same = run_tristim({"compare", path("a.exr"), path("b.exr")});
    EXPECT_NE(same.standard_output.find("RMSE        0 "), std::string::npos) << same.standard_output;
}

TEST_F(AutoCommand, QuietSaysNothing) {
    const auto result = run_tristim(
        {"render", path("tiny.pbrt"), "--method", "auto", "--passes", "1", "--outfile", path("a.exr"), "--quiet"});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.standard_error, "");
}

TEST_F(AutoCommand, CommandsThatNeedOneMethodRefuse) {
    for (const std::string command : {"reference", "bench-pass"}) {
        std::vector<std::string> arguments{command, path("tiny.pbrt"), "--method", "auto"};
        if (command == "reference")
            arguments.insert(arguments.end(), {"--time", "1", "--out", path("r.exr")});
        const auto result = run_tristim(arguments);
        EXPECT_NE(result.exit_code, 0);
        EXPECT_NE(result.standard_error.find("--method auto is for render and bench: name a method here"),
                  std::string::npos)
            << result.standard_error;
    }
    EXPECT_FALSE(std::filesystem::exists(path("r.exr")));
}

TEST_F(AutoCommand, MethodsListsEveryMethod) {
    const auto result = run_tristim({"methods"});
    EXPECT_EQ(result.exit_code, 0);
    for (const MethodKind& kind : method_kinds())
        EXPECT_NE(result.standard_output.find(fmt::format("\n{} ", pattern(kind))), std::string::npos)
            << result.standard_output;
    EXPECT_NE(result.standard_output.find("\nauto "), std::string::npos) << result.standard_output;
}

/// What choosing takes counts as rendering, every repeat chooses for itself, and a bench that goes on keeps its choice.
TEST_F(AutoCommand, BenchCountsTheTrialsAndKeepsTheChoice) {
    TinyBench bench;
    bench.scene_file = path("tiny.pbrt");
    bench.folder = path("bench");
    bench.methods = "auto,tristimulus:1";
    int calls = 0;
    ASSERT_FALSE(bench.run(false, [&](const BenchProgress& progress) {
        return progress.what.find("repeat 1") == std::string::npos || ++calls < 6;
    })) << "not interrupted";
    const Repeat before = bench.results().scenes[0].runs[0].repeats.at(0);
    ASSERT_FALSE(before.method.empty());
    ASSERT_TRUE(bench.run(true));
    const SceneResults scene = bench.results().scenes[0];
    const BenchRun& automatic = scene.runs[0];
    EXPECT_EQ(automatic.label, "auto");
    EXPECT_EQ(automatic.options["method"], "auto");
    ASSERT_EQ(automatic.repeats.size(), 2U);
    EXPECT_EQ(automatic.repeats[0].method, before.method);
    EXPECT_EQ(automatic.repeats[0].trial_seconds, before.trial_seconds);
    for (const Repeat& repeat : automatic.repeats) {
        EXPECT_TRUE(parse_method(repeat.method).unbiased());
        EXPECT_GT(repeat.trial_seconds, 0.0);
        EXPECT_GT(repeat.checkpoints.front().seconds, repeat.trial_seconds);
        EXPECT_TRUE(repeat.finished);
    }
    for (const Repeat& repeat : scene.runs[1].repeats) {
        EXPECT_EQ(repeat.method, "tristimulus:1");
        EXPECT_EQ(repeat.trial_seconds, 0.0);
    }
    ASSERT_EQ(scene.groups[0].notes.size(), 1U);
    EXPECT_NE(scene.groups[0].notes[0].find("Chosen for auto"), std::string::npos) << scene.groups[0].notes[0];
    EXPECT_NE(scene.groups[0].notes[0].find(automatic.repeats[1].method), std::string::npos);
}

} // namespace
} // namespace tristim::test
