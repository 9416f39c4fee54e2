// Curves of error before a core was mended, kept in data/: they broke today's bounds, and today's curves do not.
#include "kernel_harness.h"
#include "selftest/selftest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace tristim::test {
namespace {

using namespace selftest;

/// The fields of a line of such a file: quoted ones may hold commas.
std::vector<std::string> fields(const std::string& line) {
    std::vector<std::string> list(1);
    bool quoted = false;
    for (const char c : line) {
        if (c == '"')
            quoted = !quoted;
        else if (c == ',' && !quoted)
            list.emplace_back();
        else
            list.back() += c;
    }
    return list;
}

class OpticsCurve : public testing::TestWithParam<const char*> {};

TEST_P(OpticsCurve, LiesBelowTheBoundThatItBroke) {
    std::ifstream file(std::string(TRISTIM_SOURCE_DIR "/tests/stability/data/optics-") + GetParam() + "-before.csv");
    ASSERT_TRUE(file.is_open());
    std::string line, name;
    std::getline(file, line);
    double worst_before = 0.0;
    while (std::getline(file, line)) {
        const std::vector<std::string> values = fields(line);
        ASSERT_EQ(values.size(), 6U) << line;
        name = values[1];
        worst_before = std::max(worst_before, std::stod(values[5]));
    }
    for (const Case& c : all_cases()) {
        if (c.name != name)
            continue;
        EXPECT_GT(worst_before, 100.0 * c.bound);
        const Outcome outcome = selftest::run(c, {kernel_test::test_device(), false, 1.0});
        ASSERT_EQ(outcome.failure, "");
        ASSERT_GT(outcome.found.curve.size(), 10U);
        for (const CurvePoint& point : outcome.found.curve)
            EXPECT_LE(point.error, c.bound) << c.parameter << " = " << point.parameter;
        return;
    }
    FAIL() << "there is no case " << name;
}

INSTANTIATE_TEST_SUITE_P(OpticsStability, OpticsCurve,
                         testing::Values("grazing", "matched_reflectance", "conductors", "matched_refraction_pdf",
                                         "matched_rough_values", "matched_rough_paths"),
                         [](const auto& test) { return std::string(test.param); });

} // namespace
} // namespace tristim::test
