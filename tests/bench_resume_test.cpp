// A bench that is interrupted goes on where it was, or says why it cannot.
#include "bench_folder.h"
#include "synthetic_runs.h"

namespace tristim::test {
namespace {

/// Renders in which each pass depends on those before are the hardest to continue.
RenderOptions tiny_options(const Scene& scene, bool statistics_radius) {
    RenderOptions options = TinyBench().options(scene);
    options.statistics_radius = statistics_radius;
    options.seed = 11;
    return options;
}

void render_passes(Contestant& contestant, int passes) {
    for (int pass = 0; pass < passes; ++pass)
        contestant.render(0.0);
}

class BenchState : public testing::TestWithParam<bool> {
  protected:
    BenchState() : scene(folder.load(tiny_scene())), options(tiny_options(scene, GetParam())) {
        reference.full_width = reference.full_height = 16;
        reference.region = {0, 0, 16, 16};
        reference.xyz.resize(256);
    }

    Contestant contestant() const { return pass_by_pass(scene, options); }
    void measure(Contestant& contestant) const { contestant.measure(reference, {{"image", reference.region}}); }

    SceneFolder folder;
    Scene scene;
    RenderOptions options;
    XyzImage reference;
};

TEST_P(BenchState, RestoredRenderIsThatOfEqualPasses) {
    Contestant whole = contestant();
    render_passes(whole, 9);

    Contestant first = contestant();
    render_passes(first, 2);
    measure(first);
    render_passes(first, 2);
    first.save(folder.path("state.cbor"));
    const Repeat measured_before = first.repeat();
    render_passes(first, 1);
    measure(first); // later than the state

    Contestant second = contestant();
    const double built = second.repeat().build_seconds;
    second.restore(folder.path("state.cbor"), first.repeat());
    EXPECT_EQ(second.repeat().checkpoints.size(), 1U) << "what is later than the state is measured again";
    EXPECT_EQ(second.repeat().checkpoints.at(0).passes, 2U);
    EXPECT_GT(second.seconds(), measured_before.checkpoints.at(0).seconds);
    EXPECT_GT(second.repeat().build_seconds, built) << "both builds count";
    EXPECT_EQ(second.repeat().compare_seconds, first.repeat().compare_seconds);
    render_passes(second, 5);
    measure(second);
    EXPECT_EQ(second.image().xyz, whole.image().xyz);
    EXPECT_EQ(second.repeat().checkpoints.back().passes, 9U);
    EXPECT_EQ(second.repeat().checkpoints.back().photons, 9U * 256U);
    EXPECT_GT(second.repeat().checkpoints.back().seconds, second.repeat().checkpoints.front().seconds);
    EXPECT_FALSE(second.finished());
}

INSTANTIATE_TEST_SUITE_P(Radius, BenchState, testing::Values(false, true),
                         [](const auto& radius) { return radius.param ? "statistics" : "global"; });

TEST(BenchDamagedState, NoStateIsAStart) {
    const SceneFolder folder;
    const Scene scene = folder.load(tiny_scene());
    Contestant fresh = pass_by_pass(scene, tiny_options(scene, false));
    fresh.restore(folder.path("none.cbor"), Repeat{});
    EXPECT_EQ(fresh.seconds(), 0.0);
    Contestant other = pass_by_pass(scene, tiny_options(scene, false));
    render_passes(fresh, 3);
    render_passes(other, 3);
    EXPECT_EQ(fresh.image().xyz, other.image().xyz);
}

TEST(BenchDamagedState, IsRefused) {
    const SceneFolder folder;
    const Scene scene = folder.load(tiny_scene());
    Contestant contestant = pass_by_pass(scene, tiny_options(scene, false));
    contestant.render(0.0);
    contestant.save(folder.path("state.cbor"));
    const std::string good = read_text(folder.path("state.cbor"));
    const nlohmann::json state = nlohmann::json::from_cbor(good);
    const auto refused = [&](const std::string& bytes, const std::string& what) {
        const std::string path = folder.write("bad.cbor", bytes);
        SCOPED_TRACE(what);
        expect_message(error_of([&] { contestant.restore(path, Repeat{}); }),
                       "cannot go on from \"" + path + "\": ", "damaged or of another image");
    };
    const auto to_bytes = [](const nlohmann::json& json) {
        const std::vector<std::uint8_t> bytes = nlohmann::json::to_cbor(json);
        return std::string(bytes.begin(), bytes.end());
    };
    refused("", "empty");
    refused(good.substr(0, good.size() - 1), "cut short");
    refused("no state at all", "text");
    refused(to_bytes(nlohmann::json::array()), "a list");
    for (const auto& [name, value] : state.items()) {
        nlohmann::json other = state;
        other.erase(name);
        refused(to_bytes(other), "without " + name);
        other[name] = "five";
        refused(to_bytes(other), "a text for " + name);
    }
    nlohmann::json other_seed = state;
    other_seed["seed"] = 12;
    refused(to_bytes(other_seed), "of another seed");
    nlohmann::json smaller = state;
    smaller["film"].get_binary().pop_back();
    refused(to_bytes(smaller), "of fewer pixels");
}

class BenchResume : public testing::Test {
  protected:
    BenchResume() {
        std::filesystem::create_directory(folder.path("tiny"));
        bench.scene_file = folder.write("tiny/scene.pbrt", tiny_scene());
        bench.folder = folder.path("out");
    }

    /// Ends the bench at the n-th call (from 1 on) about this; 0: never.
    BenchCallback stop_at(const std::string& what, int n) const {
        const double total = bench.reference_seconds + 2.0 * bench.repeats * bench.seconds;
        return [=, calls = 0, done = 0.0](const BenchProgress& progress) mutable {
            EXPECT_NEAR(progress.total, total, 1e-9);
            EXPECT_GE(progress.done, done - 1e-9) << progress.what;
            EXPECT_LE(progress.done, progress.total);
            done = progress.done;
            return progress.what.find(what) == std::string::npos || ++calls != n;
        };
    }

    /// All that a whole bench promises, whether it was interrupted or not.
    void expect_whole() const {
        const BenchResults results = bench.results();
        const SceneResults& scene = results.scenes.at(0);
        EXPECT_FALSE(std::filesystem::exists(bench.path("state")));
        EXPECT_TRUE(std::filesystem::exists(bench.path(scene.image)));
        EXPECT_TRUE(std::filesystem::exists(bench.path(scene.reference.file)));
        ASSERT_EQ(scene.runs.size(), 2U);
        for (const BenchRun& run : scene.runs) {
            EXPECT_TRUE(std::filesystem::exists(bench.path(run.image)));
            EXPECT_TRUE(std::filesystem::exists(bench.path(run.error_map)));
            ASSERT_EQ(run.repeats.size(), static_cast<std::size_t>(bench.repeats));
            for (std::size_t i = 0; i < run.repeats.size(); ++i) {
                const Repeat& repeat = run.repeats[i];
                EXPECT_EQ(repeat.seed, bench.seed + i);
                EXPECT_TRUE(repeat.finished);
                EXPECT_GT(repeat.build_seconds, 0.0);
                EXPECT_GT(repeat.compare_seconds, 0.0);
                ASSERT_FALSE(repeat.checkpoints.empty());
                EXPECT_GE(repeat.checkpoints.back().seconds, bench.seconds);
                for (std::size_t k = 1; k < repeat.checkpoints.size(); ++k) {
                    EXPECT_GT(repeat.checkpoints[k].seconds, repeat.checkpoints[k - 1].seconds);
                    EXPECT_GT(repeat.checkpoints[k].passes, repeat.checkpoints[k - 1].passes);
                }
            }
        }
    }

    /// The last checkpoint's errors are those of as many passes rendered in one go.
    void expect_render_in_one_go(std::size_t run, std::size_t repeat) const {
        const BenchPlan plan = bench.plan();
        const SceneResults results = bench.results().scenes.at(0);
        const CurvePoint last = results.runs.at(run).repeats.at(repeat).checkpoints.back();
        const XyzImage reference = read_reference(bench.path(results.reference.file)).image;
        RenderOptions options = plan.scenes.at(0).options.at(run);
        options.seed = bench.seed + static_cast<std::uint32_t>(repeat);
        Contestant contestant = pass_by_pass(plan.scenes[0].scene, options);
        for (std::uint64_t pass = 0; pass < last.passes; ++pass)
            contestant.render(0.0);
        contestant.measure(reference, results.regions);
        EXPECT_EQ(contestant.repeat().checkpoints.at(0).rmse, last.rmse);
        EXPECT_EQ(contestant.repeat().checkpoints[0].rel_mse, last.rel_mse);
    }

    SceneFolder folder;
    TinyBench bench;
};

TEST_F(BenchResume, InterruptedAgainAndAgain) {
    bench.seconds = 0.1;
    const auto now = [&] { return bench.results().scenes.at(0); };

    EXPECT_FALSE(bench.run(false, stop_at("reference", 4)));
    EXPECT_EQ(now().reference.passes, 3U);

    // Two builds, then 16 turns of 2.5 ms or more, by which both have measured at 10 ms.
    constexpr int calls = 19;
    EXPECT_FALSE(bench.run(true, stop_at("repeat 1 of 2", calls)));
    const SceneResults in_first = now();
    EXPECT_GT(in_first.reference.passes, 3U);
    for (const BenchRun& run : in_first.runs) {
        EXPECT_FALSE(run.repeats.at(0).checkpoints.empty());
        EXPECT_TRUE(std::filesystem::exists(bench.path(run.image))) << "of what there is";
    }

    EXPECT_FALSE(bench.run(true, stop_at("repeat 2 of 2", calls)));
    expect_render_in_one_go(0, 0);
    const auto in_second = to_json(bench.results());
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_TRUE(now().runs[i].repeats.at(0).finished);
        EXPECT_FALSE(now().runs[i].repeats.at(1).checkpoints.empty());
        const auto& kept = in_first.runs[i].repeats[0].checkpoints;
        for (std::size_t k = 0; k < kept.size(); ++k)
            EXPECT_EQ(now().runs[i].repeats[0].checkpoints.at(k).seconds, kept[k].seconds) << "measured anew";
    }

    EXPECT_FALSE(bench.run(true, stop_at("repeat 2 of 2: building", 1))) << "before it has done anything";

    const BenchCallback watch = stop_at("", 0);
    EXPECT_TRUE(bench.run(true, [&](const BenchProgress& progress) {
        EXPECT_EQ(progress.what.find("repeat 1 of 2"), std::string::npos) << "finished repeats are not rendered again";
        return watch(progress);
    }));
    expect_whole();
    expect_render_in_one_go(1, 1);
    const auto last = to_json(bench.results());
    for (std::size_t i = 0; i < 2; ++i)
        EXPECT_EQ(last["scenes"][0]["runs"][i]["repeats"][0], in_second["scenes"][0]["runs"][i]["repeats"][0]);
    EXPECT_EQ(last["started"], in_second["started"]);
}

TEST_F(BenchResume, InterruptedBeforeTheReferenceTellsItsError) {
    expect_message(error_of([&] { bench.run(false, stop_at("reference", 1)); }), "interrupted", "first pass");
    expect_message(error_of([&] { bench.run(false, stop_at("reference", 2)); }), "", "interrupted too early");
    EXPECT_FALSE(std::filesystem::exists(bench.path("results.json"))) << "so the same command goes on";
    EXPECT_FALSE(bench.run(false, stop_at("reference", 2)));
    EXPECT_EQ(bench.results().scenes.at(0).reference.passes, 2U);
}

TEST_F(BenchResume, DamagedStateIsNamedAndDoesNotCountWithoutResults) {
    bench.repeats = 1;
    bench.seconds = 0.15;
    int turns = 0;
    EXPECT_FALSE(
        bench.run(false, [&](const BenchProgress& progress) { return progress.what != "tiny" || ++turns < 5; }));
    for (const auto& file : std::filesystem::directory_iterator(bench.path("state")))
        std::ofstream(file.path()) << "damaged";
    const auto before = contents(bench.folder);
    expect_message(error_of([&] { bench.run(true); }), "cannot go on from \"" + bench.path("state"), "damaged");
    EXPECT_TRUE(contents(bench.folder) == before);

    // What a user keeps in the folder stays.
    std::filesystem::create_directories(bench.path("state/own"));
    std::filesystem::remove(bench.path("results.json"));
    EXPECT_TRUE(bench.run(false));
    EXPECT_TRUE(std::filesystem::remove(bench.path("state/own")));
    EXPECT_TRUE(std::filesystem::remove(bench.path("state"))) << "states are left behind";
    expect_whole();
}

/// What is there stays as it is when it does not fit.
TEST_F(BenchResume, BenchOfAnotherPlanIsNeitherOverwrittenNorContinued) {
    bench.repeats = 1;
    bench.seconds = 0.005;
    EXPECT_TRUE(bench.run(false, stop_at("", 0)));
    expect_whole();
    auto before = contents(bench.folder);
    const auto expect_refused = [&](const TinyBench& other, bool resume, const std::string& words) {
        SCOPED_TRACE(words);
        const std::string message = error_of([&] {
            other.run(resume, [](const BenchProgress&) {
                ADD_FAILURE() << "something was rendered";
                return false;
            });
        });
        expect_message(message, "", words);
        EXPECT_TRUE(contents(bench.folder) == before) << "what was there has changed";
    };
    expect_refused(bench, false, "\"" + bench.folder + "\" holds a bench");

    const auto expect_no_resume = [&](const std::function<void(TinyBench&)>& change, const std::string& words) {
        TinyBench other = bench;
        change(other);
        expect_refused(other, true, words);
    };
    const auto with_options = [](const std::function<void(RenderOptions&)>& change) {
        return [=](TinyBench& b) { b.change = change; };
    };
    expect_no_resume([](TinyBench& b) { b.seconds = 0.006; }, "other --time: 0.005");
    expect_no_resume([](TinyBench& b) { b.repeats = 3; }, "other --repeats: 1");
    expect_no_resume([](TinyBench& b) { b.seed = 5; }, "other --seed: 0");
    expect_no_resume([](TinyBench& b) { b.methods = "rgb"; }, "other scenes or methods");
    expect_no_resume([](TinyBench& b) { b.methods = "tristimulus:1,rgb"; }, "other methods or options");
    expect_no_resume([](TinyBench& b) { b.methods = "rgb,tristimulus:2"; }, "other methods or options");
    expect_no_resume(with_options([](RenderOptions& o) { o.photons_per_pass = 257; }), "other methods or options");
    expect_no_resume(with_options([](RenderOptions& o) { o.radius_factor = 0.5; }), "other methods or options");
    expect_no_resume(with_options([](RenderOptions& o) { o.width = o.region.width = 17; }), "other --resolution");
    expect_no_resume([](TinyBench& b) { b.regions = {"left=0,0,9,16"}; }, "other regions");
    expect_no_resume([](TinyBench& b) { b.regions.clear(); }, "other regions");
    expect_no_resume([](TinyBench& b) { b.devices = 2; }, "other devices");
    expect_no_resume([](TinyBench& b) { b.costs = true; }, "other aims");
    expect_no_resume([](TinyBench& b) { b.reference_method = "rgb"; }, "other --reference-method: tristimulus:1");

    std::filesystem::create_directory(folder.path("elsewhere"));
    const std::string elsewhere = folder.write("elsewhere/scene.pbrt", tiny_scene());
    expect_no_resume([&](TinyBench& b) { b.scene_file = elsewhere; }, "other scenes or methods");
    folder.write("tiny/scene.pbrt", tiny_scene("0.1 0.2 0.3"));
    expect_refused(bench, true, "it shows another scene");
    folder.write("tiny/scene.pbrt", tiny_scene("0.7 0.3 0.1", 60));
    expect_refused(bench, true, "its camera is another one");
    folder.write("tiny/scene.pbrt", tiny_scene());

    // More time for the reference would make errors of before and after differ in what they are measured against.
    TinyBench longer = bench;
    longer.reference_seconds = 1.0;
    const ReferenceSummary reference = bench.results().scenes.at(0).reference;
    EXPECT_TRUE(longer.run(true));
    EXPECT_EQ(bench.results().scenes.at(0).reference.passes, reference.passes);
    std::filesystem::remove(bench.path(reference.file));
    before = contents(bench.folder);
    expect_refused(bench, true, reference.file);
}

TEST_F(BenchResume, GivenReferenceMustStayTheSame) {
    const Scene scene = load_scene(bench.scene_file);
    RenderOptions options = bench.options(scene);
    options.seed = reference_seed;
    bench.reference = folder.path("given.exr");
    const auto lengthen = [&](double seconds) {
        render_reference(scene, bench.scene_file, options, test_device(), seconds, bench.reference,
                         [](std::uint64_t, double) { return true; });
    };
    lengthen(0.1);
    bench.seconds = 0.005;
    bench.repeats = 1;
    EXPECT_TRUE(bench.run(false));
    EXPECT_EQ(bench.results().scenes[0].reference.file, bench.reference);
    EXPECT_TRUE(bench.run(true)) << "there is nothing left to do";

    TinyBench other = bench;
    other.reference = folder.path("copy.exr");
    std::filesystem::copy_file(bench.reference, other.reference);
    expect_message(error_of([&] { other.run(true); }), "cannot go on", "other --reference: " + bench.reference);
    lengthen(0.2);
    expect_message(error_of([&] { bench.run(true); }), "cannot go on", "was measured against");
}

} // namespace
} // namespace tristim::test
