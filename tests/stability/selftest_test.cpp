// `tristim selftest`: every case on the test device, and the command on other devices, on one that computes wrongly and
// on bad input.
#include "child_process.h"
#include "kernel_harness.h"
#include "scene_folder.h"
#include "selftest/selftest.h"
#include "test_names.h"
#include "test_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

namespace tristim::test {
namespace {

using selftest::Case;
using selftest::Measurement;
using selftest::Outcome;

std::set<std::string> groups() {
    std::set<std::string> names;
    for (const Case& c : selftest::all_cases())
        names.insert(c.group);
    return names;
}

class SelftestGroup : public testing::TestWithParam<std::tuple<std::string, bool>> {};

TEST_P(SelftestGroup, KeepsItsBounds) {
    const auto& [group, fast] = GetParam();
    for (const Case& c : selftest::all_cases()) {
        if (c.group != group)
            continue;
        const Outcome outcome = selftest::run(c, {kernel_test::test_device(), fast, 1.0});
        EXPECT_TRUE(outcome.passed()) << c.name << ": " << outcome.failure << "error " << outcome.found.worst
                                      << ", bound " << outcome.bound() << ", at " << outcome.found.where;
        EXPECT_FALSE(outcome.found.curve.empty()) << c.name;
    }
}

INSTANTIATE_TEST_SUITE_P(Groups, SelftestGroup, testing::Combine(testing::ValuesIn(groups()), testing::Bool()),
                         [](const auto& test) {
                             return test_name(std::get<0>(test.param)) +
                                    (std::get<1>(test.param) ? "_fast" : "_precise");
                         });

TEST(Selftest, WorstErrorAndCurve) {
    Measurement found;
    found.add(2.0, 0.5, [] { return "first"; });
    found.add(1.0, 0.25, [] { return "second"; });
    found.add(2.0, 0.75, [] { return "third"; });
    EXPECT_EQ(found.worst, 0.75);
    EXPECT_EQ(found.where, "third");
    EXPECT_EQ(found.inputs, 3U);
    ASSERT_EQ(found.curve.size(), 2U);
    EXPECT_EQ(found.curve[0].parameter, 1.0);
    EXPECT_EQ(found.curve[1].error, 0.75);
    found.add(3.0, std::nan(""), [] { return "not a number"; });
    EXPECT_EQ(found.worst, std::numeric_limits<double>::infinity());
    EXPECT_EQ(found.where, "not a number");
}

TEST(Selftest, ACasePassesOnlyIfItMeasuredWithinItsBound) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const auto outcome = [](double error, int count, double bound = 1e-3) {
        const Case c{"group", "name", "parameter", "error", bound, 1e-1, [=](const selftest::Setting&) {
                         Measurement found;
                         for (int i = 0; i < count; ++i)
                             found.add(i, error, [] { return "here"; });
                         return found;
                     }};
        return selftest::run(c, {kernel_test::test_device(), false, 1.0});
    };
    EXPECT_TRUE(outcome(1e-3, 2).passed());
    EXPECT_FALSE(outcome(1.1e-3, 2).passed());
    EXPECT_FALSE(outcome(0.0, 0).passed()) << "nothing was measured";
    EXPECT_FALSE(outcome(std::nan(""), 1).passed());
    EXPECT_TRUE(outcome(1e30, 1, infinity).passed()) << "nothing promised but finite results";
    EXPECT_FALSE(outcome(std::nan(""), 1, infinity).passed());
    const std::string table = selftest::table({outcome(1.1e-3, 2)});
    EXPECT_NE(table.find("FAILED"), std::string::npos) << table;
    EXPECT_NE(table.find("here"), std::string::npos) << table;
}

TEST(Selftest, WhatACaseThrowsIsItsFailure) {
    const Case c{"group", "name", "parameter", "error", 1.0, 1.0, [](const selftest::Setting&) -> Measurement {
                     fail("kernel 'film.cl' does not build");
                 }};
    const Outcome outcome = selftest::run(c, {kernel_test::test_device(), false, 1.0});
    EXPECT_FALSE(outcome.passed());
    EXPECT_NE(selftest::table({outcome}).find("kernel 'film.cl' does not build"), std::string::npos);
}

TEST(SelftestCommand, ListsEveryCaseWithItsBounds) {
    const ChildResult result = run_tristim({"selftest", "--list"});
    EXPECT_EQ(result.exit_code, 0);
    for (const Case& c : selftest::all_cases())
        EXPECT_NE(result.standard_output.find(c.name), std::string::npos) << c.name;
}

TEST(SelftestCommand, WritesCurves) {
    const SceneFolder folder;
    const ChildResult result = run_tristim({"selftest", "--group", "accumulation", "--math", "precise", "--effort",
                                            "0.01", "--curves", folder.path("curves.csv"), "--quiet"});
    EXPECT_EQ(result.exit_code, 0) << result.standard_output << result.standard_error;
    const std::string csv = read_text(folder.path("curves.csv"));
    EXPECT_EQ(csv.rfind("group,case,math,parameter,value,error\n", 0), 0U);
    EXPECT_NE(csv.find("\naccumulation,"), std::string::npos);
}

TEST(SelftestCommand, BadInput) {
    const auto expect = [](const std::vector<std::string>& arguments, const std::string& words) {
        const ChildResult result = run_tristim(arguments);
        EXPECT_NE(result.exit_code, 0);
        EXPECT_NE(result.standard_error.find(words), std::string::npos) << result.standard_error;
    };
    expect({"selftest", "--group", "cheese"}, "no group \"cheese\": there are film");
    expect({"selftest", "--effort", "0"}, "--effort must be above 0");
    expect({"selftest", "--math", "sloppy"}, "--math");
    expect({"selftest", "--curves", "/nowhere/curves.csv"}, "/nowhere");
    expect({"selftest", "--device", "no such device"}, "no such device");
}

/// A device that relaxes arithmetic unasked: PoCL takes options for everything it compiles. Its cache does not know of
/// them, so that this needs one of its own.
TEST(SelftestCommand, FindsADeviceThatComputesWrongly) {
    const SceneFolder cache;
    const ChildResult result =
        run_tristim({"selftest", "--group", "film", "--math", "precise", "--effort", "0.05", "--quiet"},
                    {{"POCL_EXTRA_BUILD_FLAGS", "-cl-fast-relaxed-math"},
                     {"POCL_CACHE_DIR", cache.path("pocl")},
                     {"TRISTIM_DEVICE", "Portable Computing Language"}});
    EXPECT_EQ(result.exit_code, 1) << result.standard_error;
    EXPECT_NE(result.standard_output.find("FAILED"), std::string::npos) << result.standard_output;
    EXPECT_NE(result.standard_output.find("the worst is at"), std::string::npos) << result.standard_output;
}

/// Some groups; all of them build for a minute.
TEST(SelftestCommand, PassesOnRusticl) {
    std::vector<std::string> arguments{"selftest", "--device", "rusticl", "--quiet", "--effort", "0.1"};
    if (!long_tests())
        arguments.insert(arguments.end(), {"--math", "precise", "--group", "accumulation", "--group", "photon",
                                           "--group", "spectrum", "--group", "sequence"});
    const ChildResult result = run_tristim(arguments, {{"RUSTICL_ENABLE", "llvmpipe"}});
    EXPECT_EQ(result.exit_code, 0) << result.standard_output << result.standard_error;
}

TEST(SelftestCommand, PassesOnOclgrindWithoutAReport) {
    const SceneFolder folder;
    const std::string log = folder.path("oclgrind.log");
    std::vector<std::string> arguments{
        "oclgrind", "--check-api", "--log",    log,        TRISTIM_COMMAND,
        "selftest", "--device",    "oclgrind", "--effort", long_tests() ? "0.01" : "0.001",
        "--math",   "precise",     "--quiet"};
    if (!long_tests())
        arguments.insert(arguments.end(), {"--group", "optics", "--group", "photon"});
    const ChildResult result = run_program("/usr/bin/env", arguments);
    EXPECT_EQ(result.exit_code, 0) << result.standard_output << result.standard_error;
    EXPECT_EQ(read_text(log), "");
}

} // namespace
} // namespace tristim::test
