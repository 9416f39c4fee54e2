// What stands behind the film cases of `tristim selftest`: they find faults, the errors that were there before they
// were mended are gone, and what errors are left, where many layers resonate, are those of the inputs' last digits.
#include "kernel_harness.h"
#include "selftest/film_cases.h"
#include "selftest/film_inputs.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <sstream>

namespace tristim::selftest {
namespace {

using kernel_test::test_device;

constexpr double effort = 0.2;

/// The case of this name; all that it needs lives with it.
Case case_named(const std::vector<Case>& cases, const std::string& name) {
    for (const Case& c : cases) {
        if (c.name == name)
            return c;
    }
    ADD_FAILURE() << "no case \"" << name << "\"";
    return cases.front();
}

/// The source of kernels/selftest/film.cl with everything that it includes, and one expression replaced wherever it is.
std::string mutated_source(const std::string& expression, const std::string& replacement) {
    std::string source = flatten_kernel_source("selftest/film.cl");
    std::size_t found = 0;
    for (std::size_t at = source.find(expression); at != std::string::npos;
         at = source.find(expression, at + replacement.size())) {
        source.replace(at, expression.size(), replacement);
        ++found;
    }
    EXPECT_GT(found, 0U) << "the kernels have no \"" << expression << "\"";
    return source;
}

struct Fault {
    const char* expression;
    const char* replacement;
    const char* found_by;
};

TEST(FilmStability, FaultsAreFound) {
    const Fault faults[] = {
        {"return (turns - rint(turns)) + low;", "return turns - rint(turns);", "thickness 2 µm to 1 mm"},
        {"-0.5f * expm1(exponent)", "0.5f - 0.5f * exp(exponent)", "absorption k 1e-6 to 10"},
        {"n == first.n ? first.q2.high : q2.high", "q2.high", "matched indices, 0 to 1e-3 apart"},
        {"max(power_s, SMALLEST_POWER)", "power_s", "guided modes behind opaque gaps"},
        {"if (i % 8 == 7)", "if (false)", "power in 1 to 100 layers up to 1 mm"},
        {"clamp(thickness * per_nm, (float)QUADRATURE_POINTS, (float)most)", "QUADRATURE_POINTS",
         "diffuse light under films to 1 mm"},
    };
    for (const Fault& fault : faults) {
        const std::string source = mutated_source(fault.expression, fault.replacement);
        const Case c = case_named(film_cases([&source](const Setting& setting, const Macros& macros) {
                                      return build_program_from_text(setting.device, "selftest/mutated_film.cl", source,
                                                                     macros, {});
                                  }),
                                  fault.found_by);
        EXPECT_GT(c.measure({test_device(), false, effort}).worst, c.bound)
            << fault.replacement << " in place of " << fault.expression;
    }
}

/// The errors of a curve that `tristim selftest --curves` wrote.
std::vector<double> errors_of_curve(const std::string& file) {
    const std::string path = std::string(TRISTIM_SOURCE_DIR) + "/tests/stability/data/" + file;
    std::ifstream stream(path);
    std::string line;
    std::getline(stream, line);
    EXPECT_TRUE(stream) << path;
    std::vector<double> errors;
    while (std::getline(stream, line))
        errors.push_back(std::stod(line.substr(line.rfind(',') + 1)));
    return errors;
}

/// Each curve was above today's bound somewhere, and is below it everywhere.
TEST(FilmStability, WhatBrokeIsMended) {
    const std::pair<const char*, const char*> curves[] = {
        {"film-matched-before.csv", "matched indices, 0 to 1e-3 apart"},
        {"film-guided-before.csv", "guided modes behind opaque gaps"},
        {"film-coats-before.csv", "diffuse light under films to 1 mm"},
        {"film-absorbing_coats-before.csv", "diffuse light under absorbing films"},
    };
    const std::vector<Case> cases = film_cases();
    for (const auto& [file, name] : curves) {
        const Case c = case_named(cases, name);
        const std::vector<double> before = errors_of_curve(file);
        EXPECT_GT(*std::max_element(before.begin(), before.end()), c.bound) << name;
        const Measurement now = c.measure({test_device(), false, effort});
        EXPECT_EQ(now.curve.size(), before.size()) << name;
        for (const CurvePoint& point : now.curve)
            EXPECT_LE(point.error, c.bound) << name << " at " << point.parameter << ": " << now.where;
    }
}

/// How far the exact answer may move if every input moves by an ulp, to first order.
double moved_by_ulps(const FilmPoint& point) {
    const oracle::FilmOptics exact = exact_optics(point);
    FilmPoint moved = point;
    double sum = 0.0;
    const auto move = [&](float& value, float most) {
        const float kept = value;
        double worst = 0.0;
        for (const float towards : {0.0F, most}) {
            value = std::nextafter(kept, towards);
            worst = std::max(worst, largest_difference(exact, exact_optics(moved)));
        }
        value = kept;
        sum += worst;
    };
    constexpr float infinity = std::numeric_limits<float>::infinity();
    move(moved.cos_i, 1.0F);
    for (float* value : {&moved.lambda, &moved.n0, &moved.base_n, &moved.base_k})
        move(*value, infinity);
    for (FilmPoint::Layer& layer : moved.layers) {
        for (float* value : {&layer.thickness, &layer.n, &layer.k})
            move(*value, infinity);
    }
    return sum;
}

/// Layers that resonate amplify every rounding. An error above what is promised for films to 2 µm is then no larger
/// than what some ulps of each input make of the exact answer: a field above a layer is the sum of two products of
/// rounded matrix elements with the fields below, five roundings by half an ulp each, and there are two fields.
TEST(FilmStability, LargerErrorsAreThoseOfTheInputs) {
    constexpr double promised = 5e-6, ulps = 4.0;
    FilmKernels kernels([](const Setting& setting, const Macros& macros) { return build(setting, "film.cl", macros); });
    const Setting setting{test_device(), false, 0.5};
    std::size_t larger = 0;
    for (const auto& films : {angle_inputs(setting), total_reflection_inputs(setting), random_stack_inputs(setting),
                              quarter_wave_inputs(setting)}) {
        std::vector<FilmPoint> points;
        for (const FilmInput& input : films)
            points.push_back(input.point);
        const std::vector<oracle::FilmOptics> answers = kernels.optics(setting, points, true);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const double error = absolute_error(points[i], answers[i]);
            if (error <= promised)
                continue;
            ++larger;
            EXPECT_LE(error, ulps * moved_by_ulps(points[i])) << describe(points[i]);
        }
    }
    EXPECT_GT(larger, 0U) << "nothing is left to explain: lower the bounds of the cases";
}

} // namespace
} // namespace tristim::selftest
