// The paragraph that a report says on each comparison: claims that synthetic runs with known answers allow, no others.
#include "bench/comparison.h"
#include "bench/readable.h"
#include "synthetic_runs.h"

#include <gtest/gtest.h>

namespace tristim::test::bench_paragraph_test {
namespace {

std::string text_of(const SceneResults& scene, std::size_t region = 0) {
    return describe(scene, scene.groups[0], region, compare_runs(scene, scene.groups[0], region));
}

testing::AssertionResult says(const std::string& text, const std::string& part) {
    if (text.find(part) != std::string::npos)
        return testing::AssertionSuccess();
    return testing::AssertionFailure() << '"' << part << "\" is not in: " << text;
}

ErrorLaw power_law(double c) {
    return [=](double t) { return c / std::sqrt(t); };
}

/// sqrt(b² + c²/t): an unbiased part and a bias b, in three repeats.
BenchRun biased_run(const std::string& label, double b, double c) {
    const auto law = [=](double factor) { return [=](double t) { return factor * std::sqrt(b * b + c * c / t); }; };
    return run_of(label, {law(0.99), law(1.0), law(1.01)});
}

// At the end, 102.4 s: 0.04 t^-1/2 = 0.00395, 0.066 t^-1/2 = 0.00652, and the biased run
// sqrt(0.032² + 0.02²/102.4) = 0.0321. It is passed where 0.04²/t = 0.032² + 0.02²/t, at t = 1.17 s.
SceneResults three_methods(double floor = 0.0) {
    return scene_of(
        {noisy_run("tristimulus:8", 0.04), noisy_run("spectral:400", 0.066), biased_run("rgb", 0.032, 0.02)}, floor);
}

TEST(BenchParagraph, NamesWinnerLeadCrossingAndBias) {
    EXPECT_EQ(
        text_of(three_methods()),
        "tristimulus:8 has the least error after 102 s: 0.004, 1.7 times less than the next, spectral:400 "
        "(0.0065), and 8.1 times less than the baseline, rgb (0.032), in all 3 repeats. It is ahead of rgb from "
        "1.2 s on and of spectral:400 from the first measurement on. rgb is stuck at 0.032: what is left there is "
        "most likely bias, which more time does not remove. Halving the error of tristimulus:8 takes 4 times the "
        "time.");
}

TEST(BenchParagraph, SaysWhereAFlatteningCurveIsStuck) {
    const std::string text = text_of(scene_of({biased_run("a", 0.02, 0.005), biased_run("b", 0.05, 0.05)}));
    EXPECT_TRUE(says(text, "a is stuck at 0.02 and b at 0.05: ")) << text;
    EXPECT_FALSE(says(text, "Halving")) << "a curve that is stuck has no time of halving";
    // c²/t is four times b² in the end: the curve hasn't reached its bias.
    EXPECT_FALSE(says(text_of(scene_of({biased_run("a", 0.02, 0.4)})), "stuck"));
    // The bias of progressive photon mapping itself falls as t^-1/3 with alpha = 2/3.
    EXPECT_FALSE(says(text_of(scene_of({run_of("a", {[](double t) { return std::pow(t, -1.0 / 3.0); }})})), "stuck"));
    // Three points within a factor of four of time are too few to say.
    EXPECT_FALSE(says(text_of(scene_of({run_of("a", {[](double) { return 0.02; }}, 10.0, 40.0)})), "stuck"));
    EXPECT_TRUE(
        says(text_of(scene_of({run_of("a", {[](double) { return 0.02; }}, 10.0, 80.0)})), "a is stuck at 0.02:"));
}

TEST(BenchParagraph, EqualRunsCannotBeToldApart) {
    EXPECT_EQ(
        text_of(scene_of({noisy_run("a", 0.04), noisy_run("b", 0.04)})),
        "a and b cannot be told apart after 102 s: their errors, 0.00395 each, are the same. Halving the error of "
        "a takes 4 times the time.");
    // Bands of ±1 % overlap up to a ratio of 1.01 / 0.99 = 1.0202.
    EXPECT_TRUE(says(text_of(scene_of({noisy_run("a", 0.04), noisy_run("b", 0.04 * 1.020)})),
                     "a and b cannot be told apart after 102 s: their errors, 0.00395 and 0.00403, are within the "
                     "scatter of the repeats."));
    EXPECT_TRUE(says(text_of(scene_of({noisy_run("a", 0.04), noisy_run("b", 0.04 * 1.021)})),
                     "a has the least error after 102 s: 0.00395, 2.1 % less than b (0.00404), in all 3 repeats."));
}

TEST(BenchParagraph, TiedLeadersAreAheadOfTheRestTogether) {
    EXPECT_EQ(
        text_of(scene_of({noisy_run("a", 0.04), noisy_run("b", 0.0402), noisy_run("c", 0.0404), noisy_run("d", 0.05),
                          noisy_run("e", 0.1)})),
        "a, b and c have the least error after 102 s and cannot be told apart: their errors, 0.00395, 0.00397 and "
        "0.00399, are within the scatter of the repeats. Of the others, d has 0.0049, 1.2 times as much as a; the "
        "baseline, e, has 0.0099, 2.5 times as much as a. a is ahead of d and e from the first measurement on. "
        "Halving the error of a takes 4 times the time.");
}

TEST(BenchParagraph, ASingleRepeatAllowsNoCloseClaims) {
    const auto pair = [](double ratio) {
        return text_of(scene_of({run_of("a", {power_law(0.04)}), run_of("b", {power_law(0.04 * ratio)})}));
    };
    EXPECT_TRUE(says(pair(1.04), "cannot be told apart after 102 s: their errors, 0.00395 and 0.00411, are too close "
                                 "for a single repeat."));
    EXPECT_TRUE(says(pair(2.0), "2 times less than b (0.0079). It is ahead"));
    EXPECT_TRUE(says(pair(2.0), "There is a single repeat, so how far chance moves these numbers is not known."));
}

TEST(BenchParagraph, BelowTheFloorNothingIsClaimed) {
    EXPECT_TRUE(
        says(text_of(three_methods(0.005)),
             "tristimulus:8 has the least error after 102 s, 0.004, but that is no more than the reference's own "
             "error, 0.005: how far it is ahead of spectral:400 (0.0065) cannot be said."));
    const std::string both = text_of(three_methods(0.007));
    EXPECT_TRUE(says(both, "tristimulus:8 and spectral:400 have the least error after 102 s and cannot be told apart: "
                           "their errors, 0.004 and 0.0065, are no more than the reference's own error, 0.007."));
    EXPECT_FALSE(says(both, "times less"));
    EXPECT_TRUE(says(text_of(scene_of({noisy_run("a", 0.04)}, 0.01)), "is no more than the reference's own error"));
}

TEST(BenchParagraph, NearTheFloorRatiosAreRough) {
    // 0.04 t^-1/2 passes 3 · 0.002 at 44.4 s.
    EXPECT_TRUE(says(text_of(three_methods(0.002)), "tristimulus:8 (from 44 s on) is within a factor of three of the "
                                                    "reference's own error, 0.002, so ratios with it are rough."));
    // And 0.066 t^-1/2 passes 3 · 0.003 at 53.8 s.
    EXPECT_TRUE(says(text_of(three_methods(0.003)), "tristimulus:8 (from 20 s on) and spectral:400 (from 54 s on) are "
                                                    "within a factor of three"));
    // At 0.0321 the biased run is as flat as before, but with a floor of 0.011 that may be the reference's fault.
    EXPECT_FALSE(says(text_of(three_methods(0.011)), "stuck"));
    EXPECT_FALSE(says(text_of(three_methods(0.001)), "reference"));
}

TEST(BenchParagraph, SpeaksOfTheRegion) {
    SceneResults scene = three_methods();
    scene.regions.push_back({"glass", {0, 0, 2, 2}});
    for (BenchRun& run : scene.runs)
        for (Repeat& repeat : run.repeats)
            for (CurvePoint& point : repeat.checkpoints)
                point.rmse.push_back(10.0 * point.rmse[0]);
    EXPECT_TRUE(says(text_of(scene, 1), "In the region glass, tristimulus:8 has the least error after 102 s: 0.04, "));
    scene.runs.clear();
    scene.groups[0].runs.clear();
    EXPECT_EQ(text_of(scene, 1), "In the region glass nothing has been measured.");
}

TEST(BenchParagraph, SaysWhatCanBeSaidOfLittle) {
    EXPECT_EQ(text_of(scene_of({noisy_run("a", 0.04)})),
              "a has an error of 0.00395 (0.00391 to 0.00399 over 3 repeats) after 102 s. There is no other run to "
              "compare it with. Halving the error of a takes 4 times the time.");
    EXPECT_EQ(
        text_of(scene_of({run_of("a", {power_law(0.4)}, 3.0, 3.0), run_of("b", {power_law(0.5)}, 3.0, 3.0)})),
        "a has the least error after 3 s: 0.23, 1.2 times less than b (0.29). The curves are too short yet to say "
        "how the error falls with time. There is a single repeat, so how far chance moves these numbers is not "
        "known.");
    EXPECT_TRUE(says(text_of(scene_of({run_of("a", {power_law(0.4)}, 0.1, 1.0), run_of("b", {power_law(0.5)}, 3.0)})),
                     "a has an error of 0.45 after 0.8 s. Of b nothing has been measured by then."));
    EXPECT_EQ(text_of(scene_of({BenchRun{}, BenchRun{}})), "So far nothing has been measured.");
    EXPECT_TRUE(says(text_of(scene_of({run_of("a", {power_law(0.0)}), noisy_run("b", 0.04)})),
                     "a has the least error after 102 s: none at all, against 0.004 for b."));
    EXPECT_EQ(text_of(scene_of({run_of("a", {power_law(0.0)})})),
              "a has an error of 0 after 102 s. There is no other run to compare it with.");
}

TEST(BenchParagraph, UsesTheGroupsLabelsAndQuotesThoseOfSeveralWords) {
    SceneResults scene = scene_of({noisy_run("a", 0.04), noisy_run("b", 0.08)});
    scene.groups[0].labels = {"65536 photons", "half"};
    EXPECT_TRUE(
        says(text_of(scene), "\"65536 photons\" has the least error after 102 s: 0.004, 2 times less than half "));
}

TEST(BenchParagraph, ASlowStarterIsAheadFromItsStart) {
    const SceneResults scene = scene_of({run_of("slow", {power_law(0.1)}, 4.0), run_of("fast", {power_law(0.3)})});
    EXPECT_TRUE(says(text_of(scene), "It is ahead of fast from 4 s on."));
    EXPECT_TRUE(says(text_of(scene_of({run_of("fast", {power_law(0.1)}), run_of("slow", {power_law(0.3)}, 4.0)})),
                     "It is ahead of slow from the first measurement on."));
}

TEST(BenchParagraph, SumsUpManyCrossings) {
    // 0.1 t^-1/2 against levels that it passes at (0.1 / level)²: 1, 4, 16 and 64 s.
    std::vector<BenchRun> runs{noisy_run("falling", 0.1)};
    for (double level : {0.1, 0.05, 0.025, 0.0125})
        runs.push_back(run_of(readable_number(level, 3), {[=](double) { return level; }}));
    const std::string text = text_of(scene_of(runs));
    EXPECT_TRUE(says(text, "It is ahead of all others from 64 s on, last of 0.0125."));
    runs.erase(runs.begin() + 1);
    EXPECT_TRUE(says(text_of(scene_of(runs)),
                     "It is ahead of 0.0125 from 64 s on, of 0.025 from 16 s on and of 0.05 from 4 s on."));
}

TEST(BenchReadable, Numbers) {
    EXPECT_EQ(readable_number(0.0), "0");
    EXPECT_EQ(readable_number(0.00412), "0.0041");
    EXPECT_EQ(readable_number(0.00412, 3), "0.00412");
    EXPECT_EQ(readable_number(4.12e-6), "4.1e-6");
    EXPECT_EQ(readable_number(9.96), "10");
    EXPECT_EQ(readable_number(2.0), "2");
    EXPECT_EQ(readable_number(1234.0), "1200");
    EXPECT_EQ(readable_number(99999.0), "100000");
    EXPECT_EQ(readable_number(-0.5), "-0.5");
    EXPECT_EQ(readable_number(1.0 / 0.0), "inf");
}

TEST(BenchReadable, TimeSpans) {
    EXPECT_EQ(readable_seconds(0.0004), "0.4 ms");
    EXPECT_EQ(readable_seconds(0.05), "50 ms");
    EXPECT_EQ(readable_seconds(0.0999), "0.1 s");
    EXPECT_EQ(readable_seconds(2.5), "2.5 s");
    EXPECT_EQ(readable_seconds(60.0), "60 s");
    EXPECT_EQ(readable_seconds(119.0), "119 s");
    EXPECT_EQ(readable_seconds(119.9), "2 min");
    EXPECT_EQ(readable_seconds(720.0), "12 min");
    EXPECT_EQ(readable_seconds(7199.0), "2 h");
    EXPECT_EQ(readable_seconds(12600.0), "3.5 h");
    EXPECT_EQ(readable_seconds(4.0 * 86400.0), "4 days");
}

TEST(BenchReadable, RatiosAndLists) {
    EXPECT_EQ(readable_less(1.6), "1.6 times less than");
    EXPECT_EQ(readable_less(120.0), "120 times less than");
    EXPECT_EQ(readable_less(1.05), "4.8 % less than");
    EXPECT_EQ(readable_less(1.001), "less than 1 % below");
    EXPECT_EQ(readable_more(1.05), "5 % more than");
    EXPECT_EQ(readable_more(2.5), "2.5 times as much as");
    EXPECT_EQ(readable_more(1.001), "less than 1 % above");
    EXPECT_EQ(readable_list({}), "");
    EXPECT_EQ(readable_list({"a"}), "a");
    EXPECT_EQ(readable_list({"a", "b"}), "a and b");
    EXPECT_EQ(readable_list({"a", "b", "c"}), "a, b and c");
}

} // namespace
} // namespace tristim::test::bench_paragraph_test
