// Bad input to `tristim bench` and `tristim report`: one clear sentence, a non-zero exit, nothing written.
#include "bench/reference_file.h"
#include "bench_folder.h"
#include "child_process.h"
#include "commands/bench.h"
#include "commands/report.h"

#include <algorithm>
#include <limits>

namespace tristim::test {
namespace {

class BenchErrors : public testing::Test {
  protected:
    BenchErrors() {
        scene = folder.write("scene.pbrt", tiny_scene());
        out = folder.path("out");
    }

    std::vector<std::string> arguments(const std::vector<std::string>& more) const {
        std::vector<std::string> all{"bench", scene, "--time=0.01", "--methods=rgb", "--out", out, "--quiet"};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }

    /// What the command says when it fails. Within this process, as starting one takes longer than all else.
    static std::string failure_of(const std::vector<std::string>& all) {
        CLI::App app;
        add_bench_command(app, "tristim bench");
        add_report_command(app);
        try {
            app.parse(std::vector<std::string>(all.rbegin(), all.rend()));
        } catch (const CLI::ParseError& error) {
            return error.what();
        } catch (const Error& error) {
            return error.what();
        }
        ADD_FAILURE() << "it did not fail";
        return "";
    }

    /// Expects a failure that says `words` in a single line, and leaves every file as it was.
    void expect_failure(const std::vector<std::string>& all, const std::string& words) const {
        std::string command;
        for (const std::string& argument : all)
            command += " " + argument;
        SCOPED_TRACE(command);
        const auto before = contents(folder.path(""));
        expect_message(failure_of(all), "", words);
        EXPECT_TRUE(contents(folder.path("")) == before) << "files have changed";
    }

    /// The same in a process of its own.
    void expect_process_failure(const std::vector<std::string>& all, int exit_code, const std::string& words) const {
        const auto before = contents(folder.path(""));
        const ChildResult result = run_tristim(all);
        EXPECT_EQ(result.exit_code, exit_code);
        EXPECT_EQ(result.standard_output, "");
        EXPECT_EQ(std::count(result.standard_error.begin(), result.standard_error.end(), '\n'), 1);
        EXPECT_EQ(result.standard_error.rfind("tristim: ", 0), 0U) << result.standard_error;
        EXPECT_NE(result.standard_error.find(words), std::string::npos) << result.standard_error;
        EXPECT_TRUE(contents(folder.path("")) == before) << "files have changed";
    }

    void expect_bench_failure(const std::vector<std::string>& more, const std::string& words) const {
        expect_failure(arguments(more), words);
    }

    /// A reference of the tiny scene after a few passes.
    std::string reference(const std::string& name, const std::function<void(RenderOptions&)>& change = {},
                          const std::string& scene_text = tiny_scene()) const {
        const Scene of = load_scene(folder.write("of-reference.pbrt", scene_text));
        RenderOptions options = options_from_scene(of.settings);
        options.method = parse_method("tristimulus:1");
        options.seed = reference_seed;
        if (change)
            change(options);
        render_reference(of, "of-reference.pbrt", options, test_device(), 1e6, folder.path(name),
                         [](std::uint64_t passes, double) { return passes < 4; });
        return folder.path(name);
    }

    SceneFolder folder;
    std::string scene;
    std::string out;
};

TEST_F(BenchErrors, EndTheCommandWithOneSentence) {
    expect_process_failure({"bench", scene, "--out", out}, 2, "--time is required");
    expect_process_failure({"bench", scene, "--time=nan", "--out", out}, 1, "--time must be a positive");
    expect_process_failure(arguments({"--reference", folder.path("none.exr")}), 1, "none.exr");
    expect_process_failure({"report", out}, 1, "\"" + out + "/results.json\"");
}

TEST_F(BenchErrors, BadNumbersAndChoices) {
    expect_failure({"bench", scene, "--out", out}, "--time");
    expect_failure({"bench", scene, "--time=1"}, "--out");
    expect_failure({"bench", "--time=1", "--out", out}, "scenes");
    for (const char* time : {"0", "-1", "nan", "inf"})
        expect_failure({"bench", scene, "--out", out, std::string("--time=") + time}, "--time must be a positive");
    expect_failure({"bench", scene, "--out", out, "--time=soon"}, "--time");
    expect_bench_failure({"--reference-time=0"}, "--reference-time must be a positive");
    expect_bench_failure({"--repeats=0"}, "0 repeats is not between 1 and");
    expect_bench_failure({"--repeats=-2"}, "-2 repeats is not between 1 and");
    expect_bench_failure({"--costs"}, "--methods");
    expect_bench_failure({"--no-such-option"}, "--no-such-option");
    expect_bench_failure({"--seed=-1"}, "--seed");
    expect_bench_failure({"--reference-method=spectrum"}, "unknown method 'spectrum'");
    expect_bench_failure({"--devices=no-such-device"}, "device 'no-such-device' not found");
    expect_bench_failure({"--devices=0,99"}, "device '99' not found");
    expect_bench_failure({"--resolution=16"}, "bad resolution '16'");
    expect_bench_failure({"--photons=0"}, "0 photons per pass");
}

TEST_F(BenchErrors, BadMethods) {
    const auto refused = [this](const std::string& methods, const std::string& words) {
        expect_failure({"bench", scene, "--time=0.01", "--out", out, "--methods=" + methods}, words);
    };
    refused("rgb,spectrum", "unknown method 'spectrum'");
    refused("rgb,rgb", "method 'rgb' comes twice");
    refused("rgb@golden", "bad sequence 'golden'");
}

TEST_F(BenchErrors, BadScenes) {
    expect_failure({"bench", folder.path("none.pbrt"), "--time=1", "--out", out}, folder.path("none.pbrt"));
    expect_failure({"bench", scene, folder.path("none.pbrt"), "--time=1", "--out", out}, folder.path("none.pbrt"));
    const std::string bad = folder.write("bad.pbrt", "Camera \"perspective\"\nNonsense\n");
    expect_failure({"bench", scene, bad, "--time=1", "--out", out}, bad + ":2: ");
}

TEST_F(BenchErrors, BadRegions) {
    expect_bench_failure({"--regions", "a=0,0,17,16"}, "'a=0,0,17,16' is not inside the rendered pixels 0,0,16,16");
    expect_bench_failure({"--regions", "a=0,0,8,8", "--resolution=4x4"}, "is not inside the rendered pixels 0,0,4,4");
    expect_bench_failure({"--regions", "a=0,0,8"}, "bad region '0,0,8'");
    expect_bench_failure({"--regions", "a=0,0,8,8", "--regions", "a=1,0,8,8"}, "region a comes twice");
    expect_bench_failure({"--regions", "image=0,0,8,8"}, "other than image");
    const std::string kept = folder.write("scene.regions", "# fine\nglass=0,0,8\n");
    expect_bench_failure({}, kept + ":2: bad region '0,0,8'");
}

TEST_F(BenchErrors, BadReferences) {
    const std::string good = reference("good.exr");
    const auto refused = [this](const std::string& path, const std::string& words,
                                const std::vector<std::string>& more = {}) {
        std::vector<std::string> all{"--reference", path};
        all.insert(all.end(), more.begin(), more.end());
        expect_bench_failure(all, words);
    };
    refused(folder.path("none.exr"), "none.exr");
    refused(folder.write("text.exr", "no image"), "text.exr");
    refused(good, "its resolution is 16x16, not 8x8", {"--resolution=8x8"});
    refused(good, "its region is 0,0,16,16, not 0,0,8,16", {"--region=0,0,8,16"});
    refused(good, "its maximum depth is 5, not 3", {"--max-depth=3"});
    refused(reference("scene.exr", {}, tiny_scene("0.7 0.3 0.2")), "it shows another scene");
    refused(reference("camera.exr", {}, tiny_scene("0.7 0.3 0.1", 60)), "its camera is another one");

    Reference with_nan = read_reference(good);
    write_exr(folder.path("image.exr"), with_nan.image, ColourSpace::CieXyz, {});
    refused(folder.path("image.exr"), "it was not written by tristim reference");
    with_nan.image.xyz[37][1] = std::numeric_limits<float>::quiet_NaN();
    write_reference(folder.path("nan.exr"), with_nan, {});
    refused(folder.path("nan.exr"), "nan.exr");

    expect_bench_failure({"--reference", good, "--reference", good},
                         "the number of scenes is 1 but that of --reference 2");
    std::filesystem::create_directory(folder.path("other"));
    const std::string second = folder.write("other/scene.pbrt", tiny_scene());
    expect_bench_failure({second, "--reference", good}, "the number of scenes is 2 but that of --reference 1");
    // Each is read before anything is rendered.
    expect_bench_failure({second, "--reference", good, "--reference", folder.path("none.exr")}, "none.exr");
}

TEST_F(BenchErrors, SeedsOfTheReferenceAreRefused) {
    const std::string good = reference("good.exr");
    for (const std::uint32_t half : half_seeds(reference_seed)) {
        const std::string words = fmt::format("has the seed {}, which a repeat has too", half);
        expect_bench_failure({"--reference", good, "--seed", std::to_string(half)}, words);
        expect_bench_failure({"--reference", good, "--seed", std::to_string(half - 2), "--repeats=3"}, words);
        expect_bench_failure({"--seed", std::to_string(half)}, words); // of the bench's own reference
    }
    const std::string last = reference("last.exr", [](RenderOptions& o) { o.seed = 1; });
    expect_bench_failure({"--reference", last, "--seed=4294967295", "--repeats=3"}, "has the seed 1, which");
}

TEST_F(BenchErrors, FoldersThatCannotBeWritten) {
    const std::string file = folder.write("file", "what was there");
    const auto refused = [this](const std::string& to, const std::string& words) {
        expect_failure({"bench", scene, "--time=0.01", "--methods=rgb", "--out", to}, words);
    };
    refused(file, "cannot make the folder \"" + file + "\"");
    refused(file + "/out", "cannot make the folder \"" + file + "/out\"");
    refused("/proc/out", "cannot make the folder \"/proc/out\"");
    refused("", "cannot make the folder \"\"");
    std::filesystem::create_directories(out + "/results.json");
    refused(out, "cannot write \"" + out + "/results.json\"");
}

TEST_F(BenchErrors, FoldersThatHoldOtherThings) {
    std::filesystem::create_directory(out);
    std::ofstream(out + "/results.json") << "what was there";
    expect_bench_failure({}, "\"" + out + "\" holds a bench: go on with it by --resume");
    expect_bench_failure({"--resume"}, "cannot read \"" + out + "/results.json\"");
}

TEST_F(BenchErrors, ReportsOfNothing) {
    expect_failure({"report"}, "folder");
    expect_failure({"report", folder.path("none")}, "\"" + folder.path("none") + "/results.json\"");
    std::filesystem::create_directory(out);
    expect_failure({"report", out}, "\"" + out + "/results.json\"");
    std::ofstream(out + "/results.json") << "{\"kind\": \"meth";
    expect_failure({"report", out}, "it is not a whole JSON file");
    std::ofstream(out + "/results.json") << "{\"kind\": \"methods\"}";
    expect_failure({"report", out}, "\"version\" is missing");
}

} // namespace
} // namespace tristim::test
