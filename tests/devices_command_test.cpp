// `tristim devices --check`: the table, and devices whose drivers fail, crash or hang.
#include "child_process.h"
#include "commands/device_check.h"
#include "test_scenes.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tristim::test {
namespace {

DeviceInfo named(int index, const std::string& name) {
    DeviceInfo info;
    info.index = index;
    info.name = name;
    return info;
}

/// What a check makes of a driver that does as the shell commands say.
DeviceCheck check_shell(const std::string& commands, double seconds = 60.0) {
    return check_in_child(named(0, "shell"), {"/bin/sh", "-c", commands}, {"PATH=/usr/bin:/bin", "COLOUR=red"},
                          seconds);
}

TEST(DeviceCheck, ChildrenHaveTheEnvironmentThatTheyAreGiven) {
    EXPECT_EQ(check_shell("test $COLOUR = red").failure, "");
    EXPECT_NE(check_shell("test $COLOUR = blue").failure, "");
}

TEST(DeviceCheck, TakesReportsAndLeavesOtherLinesAlone) {
    DeviceCheck check = unfinished_check(named(0, "a"));
    const std::size_t all = check.skipped.size();
    ASSERT_GT(all, 10U);
    const std::string first = check.skipped[0];
    const std::string second = check.skipped[1];
    for (const std::string& line :
         {std::string("driver 1.2 says hello"), std::string("[1]"), std::string("{"),
          nlohmann::json{{"kernel_seconds", 0.5}}.dump(), nlohmann::json{{"pass_seconds", 0.25}}.dump(),
          nlohmann::json{{"case", first}}.dump(), nlohmann::json{{"case", second}, {"failure", "error 2"}}.dump()})
        merge_report(line, check);
    EXPECT_EQ(check.kernel_seconds, 0.5);
    EXPECT_EQ(check.pass_seconds, 0.25);
    EXPECT_EQ(check.passed, 1U);
    ASSERT_EQ(check.failed.size(), 1U);
    EXPECT_EQ(check.failed[0], second + ": error 2");
    EXPECT_EQ(check.skipped.size(), all - 2);
    EXPECT_FALSE(check.ok());
}

TEST(DeviceCheck, OutlivesADriverThatCrashesFailsOrHangs) {
    const DeviceCheck crashed = check_shell(R"(echo '{"pass_seconds":1}'; kill -SEGV $$)");
    EXPECT_EQ(crashed.pass_seconds, 1.0);
    EXPECT_EQ(crashed.failure, "its driver crashed: Segmentation fault");
    EXPECT_FALSE(crashed.ok());

    const DeviceCheck ended = check_shell("exit 3");
    EXPECT_NE(ended.failure.find("status 3"), std::string::npos) << ended.failure;

    const DeviceCheck failed = check_shell(R"(echo '{"error":"kernel does not build"}')");
    EXPECT_EQ(failed.failure, "kernel does not build");

    const DeviceCheck hung = check_shell(R"(echo '{"kernel_seconds":2}'; exec sleep 1000)", 0.5);
    EXPECT_TRUE(hung.out_of_time);
    EXPECT_EQ(hung.kernel_seconds, 2.0);
    EXPECT_TRUE(hung.ok()) << "slow is not wrong";
}

TEST(DeviceCheck, TableHasARowForEachAndRatiosToTheFirstThatRendered) {
    DeviceCheck refused = unfinished_check(named(0, "toaster"));
    refused.refusal = "has no OpenCL C compiler";
    DeviceCheck first = unfinished_check(named(1, "first"));
    first.kernel_seconds = 0.125;
    first.pass_seconds = 0.02;
    first.passed = first.skipped.size();
    first.skipped.clear();
    DeviceCheck second = first;
    second.device = named(2, "second");
    second.pass_seconds = 0.05;
    second.passed -= 1;
    second.failed = {"film, thickness: error 1"};
    DeviceCheck slow = unfinished_check(named(3, "slow"));
    slow.out_of_time = true;
    DeviceCheck crashed = unfinished_check(named(4, "crashed"));
    crashed.failure = "its driver crashed";

    const std::vector<DeviceCheck> checks{refused, first, second, slow, crashed};
    const std::string table = check_table(checks);
    for (const char* words :
         {"has no OpenCL C compiler", "20.0", "1.00", "50.0", "2.50", "1 FAILED", "2 second: FAILED: film, thickness",
          "3 slow: no time left for the render, ", "4 crashed: FAILED: its driver crashed"})
        EXPECT_NE(table.find(words), std::string::npos) << words << " is not in\n" << table;

    const auto json = nlohmann::json::parse(check_json(checks));
    ASSERT_EQ(json.size(), checks.size());
    EXPECT_TRUE(json[0]["ratio_to_first"].is_null());
    EXPECT_DOUBLE_EQ(json[2]["ratio_to_first"].get<double>(), 2.5);
    EXPECT_TRUE(refused.ok());
    EXPECT_FALSE(crashed.ok());
}

TEST(DevicesCommand, EndsEachDeviceInTime) {
    const ChildResult result = run_tristim({"devices", "--check", "--time", "0.01", "--json", "--quiet"});
    EXPECT_EQ(result.exit_code, 0) << result.standard_error;
    const auto json = nlohmann::json::parse(result.standard_output);
    ASSERT_EQ(json.size(), list_devices().size());
    EXPECT_TRUE(json[0]["out_of_time"].get<bool>());
    EXPECT_GT(json[0]["skipped"].size(), 0U);
}

TEST(DevicesCommand, ChecksADevice) {
    if (!long_tests())
        GTEST_SKIP() << "set TRISTIM_LONG_TESTS=1 to build and run every case";
    const ChildResult result =
        run_tristim({"devices", "--check", "--device", "Portable Computing Language", "--effort", "0.01", "--quiet"});
    EXPECT_EQ(result.exit_code, 0) << result.standard_output << result.standard_error;
    EXPECT_EQ(result.standard_output.find("FAILED"), std::string::npos) << result.standard_output;
    EXPECT_EQ(result.standard_output.find("no time left"), std::string::npos) << result.standard_output;
}

TEST(DevicesCommand, ListsAsJsonAndRefusesBadOptions) {
    const ChildResult list = run_tristim({"devices", "--json"});
    ASSERT_EQ(list.exit_code, 0) << list.standard_error;
    const auto json = nlohmann::json::parse(list.standard_output);
    ASSERT_EQ(json.size(), list_devices().size());
    EXPECT_EQ(json[0]["name"], list_devices()[0].name);
    EXPECT_EQ(run_tristim({"devices", "--check", "--effort", "0"}).exit_code, 1);
    EXPECT_EQ(run_tristim({"devices", "--check", "--time", "-1"}).exit_code, 1);
    EXPECT_EQ(run_tristim({"devices", "--device", "no such device"}).exit_code, 1);
}

} // namespace
} // namespace tristim::test
