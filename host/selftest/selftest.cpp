#include "selftest/selftest.h"

#include "base/error.h"
#include "base/stopwatch.h"
#include "opencl/errors.h"

#include <cmath>

namespace tristim::selftest {
namespace {

/// A field of a CSV line: names of cases may hold commas.
std::string quoted(const std::string& text) {
    return fmt::format("\"{}\"", text);
}

} // namespace

std::string bound_text(double bound) {
    return std::isinf(bound) ? "finite" : fmt::format("{:.2g}", bound);
}

bool Outcome::passed() const {
    return failure.empty() && found.inputs > 0 && std::isfinite(found.worst) && found.worst <= bound();
}

Outcome run(const Case& tested, const Setting& setting) {
    Outcome outcome{tested, setting.fast_math, {}, {}, 0.0};
    const Stopwatch stopwatch;
    try {
        outcome.found = tested.measure(setting);
        if (outcome.found.inputs == 0)
            outcome.failure = "nothing was measured";
    } catch (const Error& error) {
        outcome.failure = error.what();
    } catch (const ::cl::Error& error) {
        outcome.failure = describe_opencl_error(error);
    }
    outcome.seconds = stopwatch.seconds();
    return outcome;
}

std::string table(const std::vector<Outcome>& outcomes) {
    std::string text = fmt::format("{:<14}{:<46}{:>9}  {:>11}  {:>8}  {:<6}  {}\n", "group", "case", "inputs",
                                   "worst error", "bound", "", "of");
    std::string failures;
    for (const Outcome& o : outcomes) {
        text += fmt::format("{:<14}{:<46}{:>9}  {:>11.2e}  {:>8}  {:<6}  {}\n", o.tested.group, o.tested.name,
                            o.found.inputs, o.found.worst, bound_text(o.bound()), o.passed() ? "ok" : "FAILED",
                            o.tested.error);
        if (!o.failure.empty())
            failures += fmt::format("{}, {}: {}\n", o.tested.group, o.tested.name, o.failure);
        else if (!o.passed())
            failures += fmt::format("{}, {}: the worst is at {}\n", o.tested.group, o.tested.name, o.found.where);
    }
    return text + failures;
}

std::string curves_csv(const std::vector<Outcome>& outcomes) {
    std::string csv = "group,case,math,parameter,value,error\n";
    for (const Outcome& o : outcomes) {
        for (const CurvePoint& point : o.found.curve)
            csv +=
                fmt::format("{},{},{},{},{:.6g},{:.3g}\n", o.tested.group, quoted(o.tested.name),
                            o.fast_math ? "fast" : "precise", quoted(o.tested.parameter), point.parameter, point.error);
    }
    return csv;
}

} // namespace tristim::selftest
