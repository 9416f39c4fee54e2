#include "commands/device_check.h"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace tristim {
namespace {

std::string milliseconds(const std::optional<double>& seconds) {
    return seconds ? fmt::format("{:.1f}", 1e3 * *seconds) : "-";
}

/// The time of a pass over that of the first device that rendered.
std::optional<double> ratio_to_first(const DeviceCheck& check, const std::vector<DeviceCheck>& checks) {
    const auto first = std::find_if(checks.begin(), checks.end(), [](const auto& c) { return c.pass_seconds; });
    if (first == checks.end() || !check.pass_seconds)
        return std::nullopt;
    return *check.pass_seconds / *first->pass_seconds;
}

std::string selftest_summary(const DeviceCheck& check) {
    const std::size_t ran = check.passed + check.failed.size();
    std::string text = fmt::format("{} of {}", check.passed, ran + check.skipped.size());
    if (!check.failed.empty())
        text += fmt::format(", {} FAILED", check.failed.size());
    return text;
}

/// What was skipped, cases by their groups: "the render, film 9, optics 3".
std::string without_time(const DeviceCheck& check) {
    std::vector<std::pair<std::string, int>> groups;
    for (const std::string& name : check.skipped) {
        const std::string group = name.substr(0, name.find(','));
        if (groups.empty() || groups.back().first != group)
            groups.emplace_back(group, 0);
        ++groups.back().second;
    }
    std::string text = check.pass_seconds ? "" : "the render";
    for (const auto& [group, count] : groups)
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", group, count);
    return text;
}

} // namespace

std::string check_table(const std::vector<DeviceCheck>& checks) {
    std::size_t width = 6;
    for (const DeviceCheck& check : checks)
        width = std::max(width, check.device.name.size());
    std::string text = fmt::format("{:>2}  {:<{}}  {:>10}  {:>9}  {:>9}  selftest\n", "", "device", width, "kernels/s",
                                   "pass/ms", "to first");
    std::string notes;
    for (const DeviceCheck& check : checks) {
        const std::optional<double> ratio = ratio_to_first(check, checks);
        const auto note = [&](const std::string& what) {
            notes += fmt::format("{} {}: {}\n", check.device.index, check.device.name, what);
        };
        text += fmt::format("{:>2}  {:<{}}  ", check.device.index, check.device.name, width);
        if (!check.refusal.empty()) {
            text += fmt::format("{}\n", check.refusal);
            continue;
        }
        text += fmt::format(
            "{:>10}  {:>9}  {:>9}  {}\n", check.kernel_seconds ? fmt::format("{:.2f}", *check.kernel_seconds) : "-",
            milliseconds(check.pass_seconds), ratio ? fmt::format("{:.2f}", *ratio) : "-", selftest_summary(check));
        if (!check.failure.empty())
            note("FAILED: " + check.failure);
        for (const std::string& failed : check.failed)
            note("FAILED: " + failed);
        if (check.out_of_time)
            note("no time left for " + without_time(check));
    }
    return text + notes;
}

std::string check_json(const std::vector<DeviceCheck>& checks) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    const auto number = [](const std::optional<double>& value) {
        return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
    };
    for (const DeviceCheck& check : checks)
        list.push_back({{"index", check.device.index},
                        {"name", check.device.name},
                        {"platform", check.device.platform},
                        {"driver", check.device.driver},
                        {"refusal", check.refusal},
                        {"failure", check.failure},
                        {"out_of_time", check.out_of_time},
                        {"kernel_seconds", number(check.kernel_seconds)},
                        {"pass_seconds", number(check.pass_seconds)},
                        {"ratio_to_first", number(ratio_to_first(check, checks))},
                        {"passed", check.passed},
                        {"failed", check.failed},
                        {"skipped", check.skipped}});
    return list.dump(2);
}

} // namespace tristim
