#include "commands/selftest.h"

#include "base/error.h"
#include "base/stopwatch.h"
#include "commands/device_options.h"
#include "commands/status_line.h"
#include "image/output_file.h"
#include "selftest/selftest.h"

#include <algorithm>
#include <memory>

namespace tristim {
namespace {

struct SelftestCommand {
    std::string device;
    std::string math = "both";
    std::vector<std::string> groups;
    double effort = 1.0;
    std::string curves;
    bool list = false;
    bool quiet = false;
};

std::vector<selftest::Case> chosen_cases(const std::vector<std::string>& groups) {
    std::vector<selftest::Case> cases = selftest::all_cases();
    std::vector<std::string> known;
    for (const selftest::Case& c : cases) {
        if (std::find(known.begin(), known.end(), c.group) == known.end())
            known.push_back(c.group);
    }
    for (const std::string& group : groups) {
        if (std::find(known.begin(), known.end(), group) == known.end())
            fail("selftest has no group \"{}\": there are {}", group, fmt::join(known, ", "));
    }
    if (!groups.empty())
        std::erase_if(cases, [&](const selftest::Case& c) {
            return std::find(groups.begin(), groups.end(), c.group) == groups.end();
        });
    return cases;
}

void list(const std::vector<selftest::Case>& cases) {
    fmt::print("{:<14}{:<46}{:>9}{:>9}  {}\n", "group", "case", "precise", "fast", "bounds of");
    for (const selftest::Case& c : cases)
        fmt::print("{:<14}{:<46}{:>9}{:>9}  {}\n", c.group, c.name, selftest::bound_text(c.bound),
                   selftest::bound_text(c.fast_bound), c.error);
}

void run(const SelftestCommand& command) {
    const std::vector<selftest::Case> cases = chosen_cases(command.groups);
    if (command.list)
        return list(cases);
    check_effort(command.effort);
    if (!command.curves.empty())
        check_output_file(command.curves);
    const Device device = open_device(command.device);
    fmt::print("{} ({}, driver {})\n", device.info.name, device.info.platform, device.info.driver);
    const Stopwatch stopwatch;
    std::vector<selftest::Outcome> all;
    for (const bool fast : {false, true}) {
        if (command.math == (fast ? "precise" : "fast"))
            continue;
        StatusLine status(command.quiet);
        std::vector<selftest::Outcome> outcomes;
        for (const selftest::Case& c : cases) {
            if (status.due())
                status.show(fmt::format("{}, {}", c.group, c.name));
            outcomes.push_back(selftest::run(c, {device, fast, command.effort}));
        }
        status.finish();
        fmt::print("\n--math {}\n{}", fast ? "fast" : "precise", selftest::table(outcomes));
        all.insert(all.end(), outcomes.begin(), outcomes.end());
    }
    if (!command.curves.empty())
        replace_file(command.curves, selftest::curves_csv(all));
    const auto failed = std::count_if(all.begin(), all.end(), [](const auto& outcome) { return !outcome.passed(); });
    fmt::print("\n{} of {} cases passed in {:.0f} s\n", all.size() - static_cast<std::size_t>(failed), all.size(),
               stopwatch.seconds());
    if (failed > 0)
        throw CLI::RuntimeError(1);
}

} // namespace

void add_selftest_command(CLI::App& app) {
    auto command = std::make_shared<SelftestCommand>();
    CLI::App* sub = app.add_subcommand(
        "selftest", "Compare what the kernels compute on a device with double precision: can its numbers be trusted?");
    add_device_option(*sub, command->device);
    sub->add_option("--math", command->math, "Arithmetic to test, as of render")
        ->check(CLI::IsMember({"precise", "fast", "both"}))
        ->capture_default_str();
    sub->add_option("--group", command->groups, "Only this group of cases, may be repeated [all]")->type_name("NAME");
    sub->add_option("--effort", command->effort, "Inputs over the usual number; 0.01 suits a simulator")
        ->capture_default_str();
    sub->add_option("--curves", command->curves,
                    "Write the worst error at each value of the parameter that a case varies")
        ->type_name("FILE.csv");
    sub->add_flag("--list", command->list, "List the cases and their bounds, and run none");
    sub->add_flag("--quiet", command->quiet, "No progress; the tables and errors still show");
    sub->callback([command] { run(*command); });
}

} // namespace tristim
