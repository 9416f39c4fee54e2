// `tristim bench` and `tristim report` from end to end.
#include "bench_folder.h"
#include "child_process.h"
#include "synthetic_runs.h"

#include <algorithm>
#include <chrono>

namespace tristim::test {
namespace {

class BenchCommand : public testing::Test {
  protected:
    BenchCommand() {
        std::filesystem::create_directory(folder.path("tiny"));
        scene = folder.write("tiny/scene.pbrt", tiny_scene());
        out = folder.path("out");
    }

    std::string path(const std::string& name) const { return out + "/" + name; }

    void expect_png(const std::string& name) const {
        EXPECT_EQ(read_text(path(name)).rfind("\x89PNG\r\n\x1a\n", 0), 0U) << name;
    }

    /// What every bench leaves, also one that was interrupted.
    BenchResults expect_outputs() const {
        const BenchResults results = read_results(path("results.json"));
        EXPECT_EQ(results.version, TRISTIM_VERSION);
        EXPECT_FALSE(results.machine.system.empty());
        EXPECT_GT(results.machine.threads, 0U);
        EXPECT_GT(results.peak_process_memory, 0U);
        for (const BenchDevice& device : results.devices)
            EXPECT_FALSE(device.name.empty() || device.driver.empty());
        const auto json = read_json(path("results.json"));
        std::size_t lines = 1;
        for (std::size_t i = 0; i < results.scenes.size(); ++i) {
            const SceneResults& of = results.scenes[i];
            EXPECT_EQ(json["scenes"][i]["summary"]["curves"].size(), of.runs.size());
            expect_png(of.image);
            for (const BenchRun& run : of.runs) {
                for (const Repeat& repeat : run.repeats)
                    lines += repeat.checkpoints.size() * of.regions.size();
                for (const std::string& name : {run.image, run.error_map}) {
                    if (!name.empty())
                        expect_png(name);
                }
            }
        }
        const std::string csv = read_text(path("results.csv"));
        EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), lines);
        EXPECT_NE(read_text(path("report.html")).find("</html>"), std::string::npos);
        return results;
    }

    static void expect_success(const ChildResult& result) { EXPECT_EQ(result.exit_code, 0) << result.standard_error; }

    SceneFolder folder;
    std::string scene;
    std::string out;
};

/// The same device under two numbers stands for two, as not every machine has them.
TEST_F(BenchCommand, MeasuresMethodsOnDevices) {
    const ChildResult run = run_tristim({"bench", scene, "--methods=rgb,tristimulus:1", "--time=0.1", "--repeats=2",
                                         "--seed=7", "--reference-time=0.3", "--reference-method=tristimulus:1",
                                         "--devices", "0,0", "--out", out, "--regions", "dot=3,4,4,5"});
    expect_success(run);
    EXPECT_NE(run.standard_error.find("wrote results.json"), std::string::npos) << run.standard_error;
    EXPECT_EQ(run.standard_output, "");
    const BenchResults results = expect_outputs();
    EXPECT_EQ(results.kind, "methods");
    EXPECT_EQ(results.command.rfind("tristim bench " + scene + " --methods=rgb,tristimulus:1 ", 0), 0U)
        << results.command;
    EXPECT_EQ(results.seconds, 0.1);
    EXPECT_EQ(results.devices.size(), 2U);
    ASSERT_EQ(results.scenes.size(), 1U);
    const SceneResults& of = results.scenes[0];
    EXPECT_EQ(of.name, "tiny");
    EXPECT_EQ(of.file, scene);
    EXPECT_EQ(of.regions, (std::vector<NamedRegion>{{"image", {0, 0, 16, 16}}, {"dot", {3, 4, 1, 1}}}));
    EXPECT_EQ(of.reference.file, "reference-tiny.exr");
    EXPECT_EQ(of.reference.method, "tristimulus:1");
    EXPECT_GE(of.reference.seconds, 0.3);
    EXPECT_EQ(read_reference(path(of.reference.file)).passes, of.reference.passes);
    ASSERT_EQ(of.runs.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) {
        const BenchRun& one = of.runs[i];
        EXPECT_EQ(one.device, i / 2);
        EXPECT_EQ(one.options["method"], i % 2 == 0 ? "rgb" : "tristimulus:1");
        EXPECT_EQ(one.options["photons_per_pass"], 256);
        EXPECT_GT(one.memory.bytes_per_photon, 0.0);
        ASSERT_EQ(one.repeats.size(), 2U);
        for (std::uint32_t k = 0; k < 2; ++k) {
            const Repeat& repeat = one.repeats[k];
            EXPECT_EQ(repeat.seed, 7U + k);
            EXPECT_TRUE(repeat.finished);
            EXPECT_GE(repeat.checkpoints.back().seconds, 0.1);
            // Told apart from rendering.
            EXPECT_GT(repeat.build_seconds, 0.0);
            EXPECT_GT(repeat.compare_seconds, 0.0);
        }
    }
    // One device renders the same passes, whatever its number: after one pass there is one error.
    const auto after_one_pass = [&](std::size_t i) -> std::optional<std::vector<double>> {
        const CurvePoint& first = of.runs[i].repeats[0].checkpoints.front();
        return first.passes == 1 ? std::optional(first.rmse) : std::nullopt;
    };
    if (after_one_pass(0) && after_one_pass(2)) {
        EXPECT_EQ(after_one_pass(0), after_one_pass(2));
    }
    EXPECT_FALSE(std::filesystem::exists(path("state")));
    std::size_t plots = 0;
    for (const auto& file : std::filesystem::directory_iterator(path("plots"))) {
        expect_png("plots/" + file.path().filename().string());
        ++plots;
    }
    EXPECT_GT(plots, 0U);

    // Redrawn from results.json, without rendering; an image that is gone is told of and left out.
    const std::string json = read_text(path("results.json"));
    const std::string csv = read_text(path("results.csv"));
    for (const char* name : {"results.csv", "report.html", "plots"})
        std::filesystem::remove_all(path(name));
    const std::string gone = of.runs[3].image;
    std::filesystem::rename(path(gone), folder.path("kept.png"));
    const ChildResult report = run_tristim({"report", out});
    expect_success(report);
    EXPECT_NE(report.standard_error.find(gone), std::string::npos) << report.standard_error;
    EXPECT_EQ(std::count(report.standard_error.begin(), report.standard_error.end(), '\n'), 1);
    std::filesystem::rename(folder.path("kept.png"), path(gone));
    expect_outputs();
    EXPECT_EQ(read_text(path("results.json")), json);
    EXPECT_EQ(read_text(path("results.csv")), csv);
    EXPECT_FALSE(std::filesystem::is_empty(path("plots")));
}

/// What fast arithmetic changes is told free of noise: after equal passes of equal seeds. Two scenes of one name get
/// two names.
TEST_F(BenchCommand, ComparesArithmeticAndKeepsScenesApart) {
    TinyBench bench;
    bench.scene_file = scene;
    bench.folder = out;
    bench.seconds = 0.01;
    bench.repeats = 1;
    BenchPlan plan = bench.plan();
    const Scene loaded = load_scene(scene);
    const RenderOptions base = bench.options(loaded);
    std::vector<VariantGroup> groups = cost_variants(base);
    std::erase_if(groups, [](const VariantGroup& group) { return group.name != "math"; });
    const RenderOptions reference_options = plan.scenes[0].reference_options;
    plan.scenes.push_back(plan_scene(loaded, scene, groups, plan.devices, named_regions(loaded, base, {})));
    plan.scenes.back().reference_options = reference_options;
    make_names_unique(plan.scenes);
    EXPECT_TRUE(run_bench(plan, false, [](const BenchProgress&) { return true; }));

    const BenchResults results = bench.results();
    ASSERT_EQ(results.scenes.size(), 2U);
    EXPECT_EQ(results.scenes[0].name, "tiny");
    EXPECT_EQ(results.scenes[1].name, "tiny-2");
    for (const SceneResults& of : results.scenes) {
        EXPECT_EQ(of.reference.file, "reference-" + of.name + ".exr");
        EXPECT_TRUE(std::filesystem::exists(path(of.reference.file)));
        expect_png("images/" + of.name + "-reference.png");
        for (const BenchRun& run : of.runs)
            EXPECT_EQ(run.image, "images/" + of.name + "-" + run.id + ".png");
    }
    EXPECT_TRUE(results.scenes[0].groups.at(0).notes.empty());
    const std::vector<std::string>& notes = results.scenes[1].groups.at(0).notes;
    ASSERT_EQ(notes.size(), 1U);

    constexpr int passes = 16;
    TestImage images[2];
    for (const bool fast : {false, true}) {
        RenderOptions options = base;
        options.seed = 0;
        options.fast_math = fast;
        images[fast ? 1 : 0] = render_image(loaded, options, passes);
    }
    double squares = 0.0;
    for (std::size_t i = 0; i < images[0].xyz.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            squares += std::pow(images[1].xyz[i][c] - images[0].xyz[i][c], 2);
    }
    const double rmse = std::sqrt(squares / static_cast<double>(3 * images[0].xyz.size()));
    EXPECT_NE(notes[0].find(fmt::format("differs from that of precise math by an RMSE of {:.2g}", rmse)),
              std::string::npos)
        << notes[0] << ", not " << rmse;
}

TEST_F(BenchCommand, GoesOnAfterCtrlC) {
    // A reference that is there, so that the first words on stderr come when the methods' turn has come.
    const Scene loaded = load_scene(scene);
    RenderOptions options = options_from_scene(loaded.settings);
    options.method = parse_method("tristimulus:1");
    options.seed = reference_seed;
    const std::string reference = folder.path("reference.exr");
    render_reference(loaded, scene, options, test_device(), 1e6, reference,
                     [](std::uint64_t passes, double) { return passes < 16; });
    std::vector<std::string> arguments{"bench",       scene,    "--methods=rgb,tristimulus:1", "--time=1", "--out", out,
                                       "--reference", reference};
    ChildLimits limits;
    limits.interrupt_after = std::chrono::milliseconds(400);
    const ChildResult interrupted = run_tristim(arguments, {}, limits);
    EXPECT_EQ(interrupted.exit_code, 130) << interrupted.standard_error;
    EXPECT_NE(interrupted.standard_error.find("--resume goes on"), std::string::npos) << interrupted.standard_error;
    const BenchResults before = expect_outputs();

    const std::string json = read_text(path("results.json"));
    const ChildResult again = run_tristim(arguments);
    EXPECT_EQ(again.exit_code, 1);
    EXPECT_NE(again.standard_error.find("holds a bench"), std::string::npos) << again.standard_error;
    EXPECT_EQ(read_text(path("results.json")), json);

    arguments.emplace_back("--resume");
    expect_success(run_tristim(arguments));
    const BenchResults after = expect_outputs();
    EXPECT_FALSE(std::filesystem::exists(path("state")));
    for (std::size_t i = 0; i < 2; ++i) {
        const Repeat& repeat = after.scenes.at(0).runs.at(i).repeats.at(0);
        EXPECT_TRUE(repeat.finished);
        EXPECT_GE(repeat.checkpoints.back().seconds, 1.0);
        if (before.scenes.at(0).runs.at(i).repeats.empty())
            continue;
        const auto& kept = before.scenes[0].runs[i].repeats[0].checkpoints;
        for (std::size_t k = 0; k < kept.size(); ++k)
            EXPECT_EQ(repeat.checkpoints.at(k).seconds, kept[k].seconds);
    }
}

} // namespace
} // namespace tristim::test
