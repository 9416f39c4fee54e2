// What a bench derives from its checkpoints, on synthetic errors whose answers are known in closed form.
#include "bench/analysis.h"
#include "bench/comparison.h"
#include "scene_folder.h"
#include "synthetic_runs.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <sstream>

namespace tristim::test {
namespace {

/// Rounding of a few logarithms and powers.
constexpr double rounding = 1e-12;

double power_law(double t) {
    return 0.3 / std::sqrt(t);
}

Curve curve_of(const std::vector<double>& seconds, const std::vector<double>& errors) {
    Curve curve;
    curve.seconds = seconds;
    curve.median = curve.low = curve.high = errors;
    curve.repeats = 1;
    return curve;
}

bool all_numbers_finite(const nlohmann::ordered_json& json) {
    if (json.is_number())
        return std::isfinite(json.get<double>());
    // A string would iterate over itself.
    return !json.is_structured() || std::all_of(json.begin(), json.end(), all_numbers_finite);
}

TEST(BenchCurve, InterpolatesPowerLawsExactlyBetweenRepeatsAtOtherTimes) {
    BenchRun run = run_of("a", {power_law});
    // The same law at times shifted against the first repeat's, and a law twice as high.
    run.repeats.push_back(repeat_of(power_law, 0.13, 90.0));
    run.repeats.push_back(repeat_of([](double t) { return 2.0 * power_law(t); }, 0.11, 120.0));
    const Curve curve = error_curve(run, 0);
    ASSERT_EQ(curve.repeats, 3U);
    // Common to all: from 0.13 s to the second repeat's last checkpoint, 0.13 · 2^9 s.
    EXPECT_DOUBLE_EQ(curve.seconds.front(), 0.13);
    EXPECT_DOUBLE_EQ(curve.seconds.back(), 0.13 * 512.0);
    ASSERT_EQ(curve.seconds.size(), 11U); // and 0.2, 0.4, …, 51.2 in between
    EXPECT_DOUBLE_EQ(curve.seconds[1], 0.2);
    for (std::size_t i = 0; i < curve.seconds.size(); ++i) {
        const double exact = power_law(curve.seconds[i]);
        EXPECT_NEAR(curve.median[i] / exact, 1.0, rounding);
        EXPECT_NEAR(curve.low[i] / exact, 1.0, rounding);
        EXPECT_NEAR(curve.high[i] / exact, 2.0, rounding);
    }
}

TEST(BenchCurve, MedianOfTwoRepeatsIsTheirMean) {
    const BenchRun run = run_of("a", {[](double) { return 1.0; }, [](double) { return 4.0; }});
    const Curve curve = error_curve(run, 0);
    EXPECT_DOUBLE_EQ(curve.median.back(), 2.5);
    EXPECT_DOUBLE_EQ(curve.low.back(), 1.0);
    EXPECT_DOUBLE_EQ(curve.high.back(), 4.0);
}

TEST(BenchCurve, LeavesOutInterruptedAndEmptyRepeats) {
    BenchRun run = run_of("a", {power_law, power_law});
    run.repeats.push_back(repeat_of([](double) { return 100.0; }, 0.1, 1.0));
    run.repeats.emplace_back();
    const Curve curve = error_curve(run, 0);
    EXPECT_EQ(curve.repeats, 2U);
    EXPECT_DOUBLE_EQ(curve.seconds.back(), 0.1 * 1024.0);
    EXPECT_NEAR(curve.high.back(), power_law(102.4), rounding);
    EXPECT_TRUE(error_curve(BenchRun{}, 0).seconds.empty());
    EXPECT_TRUE(error_curve(run, 1).seconds.empty()) << "there is no such region";
}

TEST(BenchCurve, SingleCheckpointsAtNearlyTheSameTimeCount) {
    BenchRun run = run_of("slow", {power_law}, 3.0, 3.0);
    run.repeats.push_back(repeat_of(power_law, 3.1, 3.1));
    const Curve curve = error_curve(run, 0);
    ASSERT_EQ(curve.seconds, std::vector{3.1});
    EXPECT_DOUBLE_EQ(curve.high[0], power_law(3.0));
    run.repeats[1] = repeat_of(power_law, 5.0, 5.0);
    EXPECT_TRUE(error_curve(run, 0).seconds.empty()) << "nothing tells how the first repeat stood after 5 s";
}

TEST(BenchCurve, TimeToReachIsExactForPowerLaws) {
    const Curve curve = error_curve(run_of("a", {power_law}), 0);
    // 0.3 t^-1/2 = e at t = (0.3 / e)².
    for (double error : {0.5, 0.1, 0.07, 0.03})
        EXPECT_NEAR(time_to_reach(curve, error).value() / std::pow(0.3 / error, 2.0), 1.0, rounding);
    EXPECT_DOUBLE_EQ(time_to_reach(curve, 2.0).value(), 0.1) << "below from the first point on";
    EXPECT_FALSE(time_to_reach(curve, 0.029)) << "0.0296 at the end";
    EXPECT_FALSE(time_to_reach(Curve{}, 1.0));
}

TEST(BenchCurve, TimeToReachLooksPastABump) {
    const Curve curve = curve_of({1, 2, 4, 8, 16}, {0.4, 0.1, 0.4, 0.1, 0.1});
    // Below 0.2 from 2^0.5 on, but not for good: from halfway between 4 and 8 in log time.
    EXPECT_NEAR(time_to_reach(curve, 0.2).value(), 4.0 * std::sqrt(2.0), 1e-12);
    EXPECT_DOUBLE_EQ(time_to_reach(curve, 0.1).value(), 8.0);
    EXPECT_DOUBLE_EQ(time_to_reach(curve, 0.4).value(), 1.0);
    EXPECT_FALSE(time_to_reach(curve_of({1, 2, 4}, {0.4, 0.1, 0.4}), 0.2));
}

TEST(BenchCurve, ZeroErrorsAreReachedAtAFiniteTime) {
    const Curve curve = curve_of({1, 4}, {0.4, 0.0});
    // Linear in log time: half the error halfway, at 2 s.
    EXPECT_DOUBLE_EQ(value_at(curve.seconds, curve.median, 2.0).value(), 0.2);
    EXPECT_DOUBLE_EQ(time_to_reach(curve, 0.2).value(), 2.0);
    EXPECT_DOUBLE_EQ(time_to_reach(curve, 0.0).value(), 4.0);
}

TEST(BenchCurve, SlopeAndHalvingOfPowerLaws) {
    const auto slope_of = [](double exponent) {
        return fitted_slope(error_curve(run_of("a", {[=](double t) { return std::pow(t, exponent); }}), 0));
    };
    EXPECT_NEAR(slope_of(-0.5).value(), -0.5, rounding);
    EXPECT_NEAR(slope_of(-1.0 / 3.0).value(), -1.0 / 3.0, rounding);
    EXPECT_NEAR(time_to_halve(slope_of(-0.5)).value(), 4.0, 1e-10);
    EXPECT_NEAR(time_to_halve(slope_of(-1.0 / 3.0)).value(), 8.0, 1e-10);
    EXPECT_FALSE(time_to_halve(0.0));
    EXPECT_FALSE(time_to_halve(0.5));
    EXPECT_FALSE(time_to_halve(-1e-5)) << "2^100000 is no number";
    EXPECT_FALSE(time_to_halve(std::nullopt));
}

TEST(BenchCurve, SlopeTakesTheLastDecadeAlone) {
    const auto kinked = [](double t) { return t < 10.0 ? 1.0 : 1.0 / std::sqrt(0.1 * t); };
    BenchRun run = run_of("a", {kinked}, 1.0, 4.0);
    for (double t : {10.0, 20.0, 50.0, 100.0}) {
        CurvePoint point = run.repeats[0].checkpoints[0];
        point.seconds = t;
        point.rmse = {kinked(t)};
        run.repeats[0].checkpoints.push_back(point);
    }
    EXPECT_NEAR(fitted_slope(error_curve(run, 0)).value(), -0.5, rounding);
    EXPECT_FALSE(fitted_slope(curve_of({1, 90, 100}, {1, 1, 1}))) << "two points lie in the last decade";
    EXPECT_FALSE(fitted_slope(curve_of({50, 90, 100}, {1, 0, 1}))) << "an error of 0 has no logarithm";
}

TEST(BenchCurve, NearFloorFromIsWhereTheMedianPassesThreeFloors) {
    const Curve curve = error_curve(run_of("a", {power_law}), 0);
    ReferenceSummary reference;
    EXPECT_FALSE(near_floor_from(curve, reference, 0)) << "no floor known";
    reference.floor = {0.02};
    EXPECT_NEAR(near_floor_from(curve, reference, 0).value(), 25.0, 1e-10); // 0.3 t^-1/2 = 0.06
    reference.floor = {0.001};
    EXPECT_FALSE(near_floor_from(curve, reference, 0));
}

TEST(BenchLevels, AreOneTwoFiveFromWhatMostReachToWhatOneReaches) {
    const auto curve = [](double first, double last) { return curve_of({1, 100}, {first, last}); };
    const std::vector curves{curve(1.0, 0.0041), curve(1.0, 0.009), curve(1.0, 0.032)};
    EXPECT_EQ(error_levels(curves, 0.0), (std::vector{0.2, 0.1, 0.05, 0.02, 0.01, 0.005}));
    EXPECT_EQ(error_levels({curve(0.0045, 0.0041)}, 0.0), std::vector{0.005}) << "more would be reached at once";
    EXPECT_EQ(error_levels(curves, 0.03), (std::vector{0.5, 0.2, 0.1, 0.05})) << "below the floor nothing is reached";
    EXPECT_EQ(error_levels({curve(1.0, 0.005)}, 0.0).back(), 0.005);
}

TEST(BenchLevels, AreAtMostSixAcrossAnyRange) {
    const auto levels = error_levels({curve_of({1, 2}, {1.0, 1e-5}), curve_of({1, 2}, {1.0, 0.9})}, 0.0);
    ASSERT_EQ(levels.size(), 6U);
    EXPECT_EQ(levels.front(), 1.0);
    EXPECT_EQ(levels.back(), 1e-5);
    EXPECT_TRUE(std::is_sorted(levels.rbegin(), levels.rend()));
    EXPECT_TRUE(error_levels({}, 0.0).empty());
    EXPECT_TRUE(error_levels({Curve{}, curve_of({1}, {0.0})}, 0.0).empty());
}

TEST(BenchComparison, AheadFromIsTheCrossing) {
    // 0.5 t^-1/2 falls below 0.1 at t = 25; from the start it is below 1.
    const SceneResults scene = scene_of({run_of("flat", {[](double) { return 0.1; }}),
                                         run_of("falling", {[](double t) { return 0.5 / std::sqrt(t); }}),
                                         run_of("bad", {[](double) { return 10.0; }})});
    const Comparison comparison = compare_runs(scene, scene.groups[0], 0);
    EXPECT_EQ(comparison.ranking, (std::vector<std::size_t>{1, 0, 2}));
    EXPECT_NEAR(comparison.ahead_from[0].value(), 25.0, 1e-10);
    EXPECT_FALSE(comparison.ahead_from[1]);
    EXPECT_DOUBLE_EQ(comparison.ahead_from[2].value(), 0.1);
    EXPECT_DOUBLE_EQ(comparison.equal_time.value(), 102.4);
}

TEST(BenchComparison, EqualTimeIsTheShortestRunsEnd) {
    SceneResults scene = scene_of({run_of("long", {power_law}), run_of("short", {power_law}, 0.15, 50.0), BenchRun{}});
    const Comparison comparison = compare_runs(scene, scene.groups[0], 0);
    EXPECT_DOUBLE_EQ(comparison.equal_time.value(), 0.15 * 256.0);
    EXPECT_NEAR(comparison.errors[0].value(), power_law(38.4), rounding);
    EXPECT_FALSE(comparison.errors[2]);
    EXPECT_EQ(comparison.ranking.size(), 2U);
}

TEST(BenchComparison, EqualCurvesAreNeverAhead) {
    const Curve a = curve_of({1, 2, 4}, {0.4, 0.3, 0.2});
    EXPECT_FALSE(stays_ahead_from(a, a, 4.0));
    EXPECT_DOUBLE_EQ(stays_ahead_from(curve_of({1, 2, 4}, {0.4, 0.3, 0.1}), a, 4.0).value(), 2.0)
        << "the same until 2 s";
    EXPECT_FALSE(stays_ahead_from(a, Curve{}, 4.0));
    EXPECT_FALSE(stays_ahead_from(a, curve_of({5, 6}, {1, 1}), 4.0));
}

TEST(BenchSummary, HasEveryPromisedKeyPerRunGroupAndRegion) {
    SceneResults scene = scene_of({noisy_run("a", 0.1), noisy_run("b", 0.3)}, 0.02);
    scene.regions.push_back({"glass", {0, 0, 2, 2}});
    scene.reference.floor.push_back(0.0);
    for (BenchRun& run : scene.runs)
        for (Repeat& repeat : run.repeats)
            for (CurvePoint& point : repeat.checkpoints)
                point.rmse.push_back(2.0 * point.rmse[0]);
    const auto summary = summarise(scene);
    ASSERT_EQ(summary.at("curves").size(), 2U);
    for (const auto& regions : summary.at("curves")) {
        ASSERT_EQ(regions.size(), 2U);
        for (const auto& curve : regions)
            for (const char* key : {"seconds", "median", "low", "high", "slope", "halving", "near_floor_from"})
                EXPECT_TRUE(curve.contains(key)) << key;
    }
    ASSERT_EQ(summary.at("groups").size(), 1U);
    ASSERT_EQ(summary.at("groups")[0].size(), 2U);
    for (const auto& group : summary.at("groups")[0]) {
        for (const char* key : {"levels", "times", "equal_time", "errors", "ranking", "ahead_from", "text"})
            EXPECT_TRUE(group.contains(key)) << key;
        ASSERT_EQ(group.at("times").size(), group.at("levels").size());
        for (const auto& times : group.at("times"))
            EXPECT_EQ(times.size(), 2U);
    }
    EXPECT_NEAR(summary["curves"][0][0]["slope"].get<double>(), -0.5, 1e-10);
    EXPECT_NEAR(summary["curves"][0][0]["halving"].get<double>(), 4.0, 1e-8);
    EXPECT_NEAR(summary["curves"][0][0]["near_floor_from"].get<double>(), std::pow(0.1 / 0.06, 2.0), 1e-8);
    EXPECT_TRUE(summary["curves"][0][1]["near_floor_from"].is_null());
    EXPECT_NEAR(summary["curves"][0][1]["median"].back().get<double>(),
                2.0 * summary["curves"][0][0]["median"].back().get<double>(), rounding);
    // BenchRun a is at 0.1 / sqrt(102.4) = 0.0099 in the end; the floor lets 0.02 be the least level.
    EXPECT_EQ(summary["groups"][0][0]["levels"].back(), 0.02);
    EXPECT_NEAR(summary["groups"][0][0]["times"].back()[0].get<double>(), 25.0, 1e-8);
    EXPECT_TRUE(summary["groups"][0][0]["times"].back()[1].is_null());
}

TEST(BenchSummary, HasNoInfinityInIt) {
    const double nan = std::nan("");
    const SceneResults scene = scene_of(
        {run_of("zero", {[](double) { return 0.0; }}), run_of("once", {power_law}, 3.0, 3.0),
         run_of("flat", {[](double) { return 0.1; }}), run_of("bad", {[=](double) { return nan; }}), BenchRun{}});
    const auto summary = summarise(scene);
    EXPECT_TRUE(all_numbers_finite(summary));
    EXPECT_EQ(summary.dump().find("nan"), std::string::npos);
    EXPECT_TRUE(summary["curves"][0][0]["slope"].is_null());
    EXPECT_TRUE(summary["curves"][1][0]["slope"].is_null());
    EXPECT_TRUE(summary["curves"][2][0]["halving"].is_null());
    EXPECT_TRUE(summary["curves"][3][0]["seconds"].empty());
    EXPECT_EQ(summary["groups"][0][0]["ranking"], (std::vector<std::size_t>{0, 2, 1}));
    EXPECT_NO_THROW(summarise(SceneResults{}));
    EXPECT_NO_THROW(summarise(scene_of({})));
}

/// Every member differs from its default.
BenchResults filled_results() {
    BenchResults results;
    results.kind = "costs";
    results.version = "1";
    results.started = "2001-02-03T04:05:06Z";
    results.command = "tristim bench";
    results.machine = {"CPU", 2, 3, "Linux"};
    results.devices = {{"other", "", "", ""}, {"device", "platform", "driver", "OpenCL C 1.2"}};
    results.seconds = 0.1;
    results.repeats = 3;
    results.seed = 4294967295U;
    results.peak_process_memory = 1ULL << 60U;
    SceneResults scene = scene_of({noisy_run("a", 0.1), noisy_run("b", 0.3)}, 0.02);
    scene.file = "scene.pbrt";
    scene.width = 8;
    scene.height = 9;
    scene.regions[0].region = {1, 2, 3, 4};
    scene.reference = {"reference.exr", "spectral:400", 5, 6.5, 7, {0.25}, {0.5}, {0.75}};
    scene.image = "reference.png";
    scene.error_map_scale = 0.125;
    scene.groups[0].title = "Methods";
    scene.groups[0].notes = {"A note."};
    BenchRun& run = scene.runs[1];
    run.device = 1;
    run.options = {{"method", "rgb"}, {"list", {1, 2}}};
    run.memory = {1, 2, 3, 4.5, 5.5};
    run.image = "b.png";
    run.error_map = "b-error.png";
    run.repeats[0].seed = 9;
    run.repeats[0].build_seconds = 0.3;
    run.repeats[0].compare_seconds = 0.7;
    results.scenes = {scene};
    return results;
}

TEST(BenchResultsFile, ReadsBackWhatWasWritten) {
    const auto json = to_json(filled_results());
    const auto text = nlohmann::ordered_json::parse(json.dump());
    const BenchResults read = results_from_json(text, "results.json");
    EXPECT_EQ(to_json(read), json);
    EXPECT_EQ(json["scenes"][0]["regions"][0]["region"], (std::vector{1, 2, 4, 6})) << "x0, y0, x1, y1";
    const auto& scene = json["scenes"][0];
    EXPECT_EQ(json["machine"].dump(), R"({"processor":"CPU","threads":2,"memory":3,"system":"Linux"})");
    EXPECT_EQ(json["devices"][1].dump(),
              R"({"name":"device","platform":"platform","driver":"driver","opencl_c":"OpenCL C 1.2"})");
    EXPECT_EQ(scene["reference"].dump(), R"({"file":"reference.exr","method":"spectral:400","passes":5,"seconds":6.5,)"
                                         R"("seed":7,"noise":[0.25],"bias":[0.5],"floor":[0.75]})");
    EXPECT_EQ(scene["groups"][0].dump(), R"({"name":"methods","title":"Methods","runs":[0,1],"labels":["a","b"],)"
                                         R"("baseline":1,"notes":["A note."]})");
    EXPECT_EQ(scene["runs"][1]["memory"].dump(),
              R"({"photons":1,"pixels":2,"scene":3,"bytes_per_photon":4.5,"bytes_per_pixel":5.5})");
    EXPECT_EQ(scene["runs"][1]["options"].dump(), R"({"method":"rgb","list":[1,2]})");
    auto repeat = scene["runs"][1]["repeats"][0];
    EXPECT_EQ(repeat["checkpoints"].size(), 11U);
    repeat.erase("checkpoints");
    EXPECT_EQ(
        repeat.dump(),
        R"({"seed":9,"method":"","trial_seconds":0.0,"build_seconds":0.3,"compare_seconds":0.7,"finished":true})");
    EXPECT_EQ(read.scenes[0].regions, filled_results().scenes[0].regions);
    EXPECT_EQ(read.devices, filled_results().devices);
    EXPECT_EQ(read.seed, 4294967295U);
    EXPECT_EQ(read.peak_process_memory, 1ULL << 60U);
    EXPECT_EQ(summarise(read.scenes[0]), summarise(filled_results().scenes[0]));
}

/// Erases each member of each object but the run's options, one at a time.
void expect_each_member_needed(const nlohmann::ordered_json& whole, const nlohmann::ordered_json::json_pointer& at) {
    const auto& json = whole.at(at);
    if (json.is_object() && !json.empty())
        for (const auto& item : json.items()) {
            auto damaged = whole;
            damaged.at(at).erase(item.key());
            const std::string message = error_of([&] { results_from_json(damaged, "results.json"); });
            expect_message(message, "cannot use \"results.json\"", item.key() + "\" is missing");
            if (item.key() != "options")
                expect_each_member_needed(whole, at / item.key());
        }
    if (json.is_array() && !json.empty())
        expect_each_member_needed(whole, at / 0);
}

TEST(BenchResultsFile, NamesWhatIsMissing) {
    expect_each_member_needed(to_json(filled_results()), nlohmann::ordered_json::json_pointer());
}

TEST(BenchCsv, HasALinePerCheckpointRegionAndRepeat) {
    BenchResults results;
    results.devices.resize(1);
    results.devices[0].name = "CPU \"x\", y";
    results.scenes = {scene_of({run_of("a", {power_law, power_law}, 1.0, 2.0)})};
    SceneResults& scene = results.scenes[0];
    scene.regions.push_back({"glass", {0, 0, 2, 2}});
    scene.runs[0].repeats[1].seed = 7;
    for (Repeat& repeat : scene.runs[0].repeats)
        for (CurvePoint& point : repeat.checkpoints) {
            point.rmse = {0.5, 0.25};
            point.rel_mse = {0.125, 2.0};
        }
    std::istringstream lines(results_csv(results));
    std::vector<std::string> read;
    for (std::string line; std::getline(lines, line);)
        read.push_back(line);
    ASSERT_EQ(read.size(), 1U + 2U * 2U * 2U);
    EXPECT_EQ(read[0], "scene,device,run,seed,region,seconds,passes,photons,memory,rmse,relmse");
    EXPECT_EQ(read[1], "scene,\"CPU \"\"x\"\", y\",a,0,image,1,1,1000,1048576,0.5,0.125");
    EXPECT_EQ(read[8], "scene,\"CPU \"\"x\"\", y\",a,7,glass,2,2,2000,1048576,0.25,2");
}

} // namespace
} // namespace tristim::test
