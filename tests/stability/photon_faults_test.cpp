// That the self-test's cases of the photon map and of accumulation can fail: each on a kernel with a fault, most of
// them what the kernels had before. And their errors as they were then, in data/.

#include "kernel_harness.h"
#include "scene_folder.h"
#include "selftest/photon_measures.h"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <sstream>

namespace tristim::test::photon_faults_test {
namespace {

using selftest::Measurement;
using selftest::Setting;

struct Fault {
    std::string what; ///< a test name
    std::string file; ///< of the program
    std::string from; ///< text that is there once
    std::string to;
    Macros macros;
    Measurement (*measure)(const Setting&, const ::cl::Program&);
    std::string case_name;
};

void PrintTo(const Fault& fault, std::ostream* out) {
    *out << fault.what;
}

Setting setting() {
    return {kernel_test::test_device(), false, 0.3};
}

selftest::Case case_of(const std::string& name) {
    for (const selftest::Case& c : selftest::all_cases()) {
        if (c.name == name)
            return c;
    }
    ADD_FAILURE() << "no case is called " << name;
    return {};
}

constexpr const char* many = "gather, 1 to 2^15 photons in a search";
constexpr const char* dense = "density of photons at the least radii";
constexpr const char* statistics = "--radius statistics over 1 to 10^6 passes";
constexpr const char* schedule = "search radius of passes 1 to 2^32";

std::vector<Fault> faults() {
    using namespace selftest;
    const Macros small_stack{{"BVH_STACK_SIZE", "8"}};
    const Macros film = accumulation::film_macros();
    return {
        {"PlainSumsOfPhotons", "gather.cl", "#define SUM_BLOCK 1024u", "#define SUM_BLOCK 0x40000000u",
         photon::gather_macros(), photon::many_photons, many},
        {"CellsOfARadius", "gather.cl", "0.4999f / as_float", "0.9999f / as_float", photon::gather_macros(),
         photon::gather_everywhere, "gather, scenes of 1e-12 to 1e12 and far away"},
        {"PhotonsCountedTwice", "gather.cl", "++gathered->count;\n#if COLOURED_EYE",
         "gathered->count += gathered->count == 7u ? 2u : 1u;\n#if COLOURED_EYE", photon::gather_macros(),
         photon::faint_photons, "gather, photons of 1e-45 to 1e35"},
        {"NoFloorOfRadii", "selftest/photon.cl",
         "return max(wanted, max(SMALLEST_RELATIVE_RADIUS * extent, SMALLEST_RADIUS));", "return wanted;", small_stack,
         photon::density, dense},
        {"FloorOfRadiiTooHigh", "selftest/photon.cl", "SMALLEST_RELATIVE_RADIUS * extent, SMALLEST_RADIUS",
         "SMALLEST_RELATIVE_RADIUS * extent, 1e-3f", small_stack, photon::radius_of_passes, schedule},
        {"AnotherRandomNumber", "selftest/photon.cl", "v.x * 1664525u", "v.x * 1664527u", small_stack,
         photon::known_answers, "known answers of the random numbers"},
        {"BlindToWhatIsNotFinite", "selftest/photon.cl", "return (as_uint(x) << 1) < 0xff000000u;", "return x == x;",
         small_stack, photon::finite_values, "values that are not finite are told"},
        {"PlainSums", "selftest/accumulation.cl", "fast_two_sum(sum, second, high, &second);",
         "*high = sum; second = third = 0.0f;", film, accumulation::sums, "sums of 1 to 10^6 samples of 1e-15 to 1e15"},
        {"PlainSumsOfSquares", "selftest/accumulation.cl", "fast_two_sum(sum, *low + lost, high, low);",
         "*high = sum; *low = 0.0f;", film, accumulation::squares, "sums of their squares"},
        {"PlainSumsInAnImage", "selftest/accumulation.cl", "fast_two_sum(sum, second, high, &second);",
         "*high = sum; second = third = 0.0f;", film, accumulation::magnitudes, "an image of 1e-33 to 1e27"},
        {"NoLargestSample", "selftest/accumulation.cl", "#define LARGEST_SAMPLE 0x1p95f",
         "#define LARGEST_SAMPLE INFINITY", film, accumulation::large_samples, "samples that would overflow"},
        {"RaysModulo32Bits", "selftest/accumulation.cl", "*carries += sum < more ? carry : 0u;", "", film,
         accumulation::counts, "counts past 2^24 and 2^32"},
        {"RadiusInOneFloat", "selftest/accumulation.cl", "f->statistics_radius_low = low.x;",
         "f->statistics_radius_low = 0.0f;", film, accumulation::statistics_radius, statistics},
    };
}

class PhotonStabilityFault : public testing::TestWithParam<Fault> {};

TEST_P(PhotonStabilityFault, IsCaught) {
    const Fault& fault = GetParam();
    std::string source = flatten_kernel_source(fault.file);
    const std::size_t at = source.find(fault.from);
    ASSERT_NE(at, std::string::npos) << fault.from;
    ASSERT_EQ(source.find(fault.from, at + 1), std::string::npos) << fault.from << " appears twice";
    source.replace(at, fault.from.size(), fault.to);
    const ::cl::Program program =
        build_program_from_text(kernel_test::test_device(), fault.file, source, fault.macros, {});
    const Measurement found = fault.measure(setting(), program);
    EXPECT_GT(found.worst, case_of(fault.case_name).bound);
}

INSTANTIATE_TEST_SUITE_P(Kernels, PhotonStabilityFault, testing::ValuesIn(faults()),
                         [](const auto& fault) { return fault.param.what; });

/// Beyond what the self-test asks of all devices: four million photons in one search.
TEST(PhotonStability, MillionsOfPhotonsInOneSearch) {
    const Setting many_more{kernel_test::test_device(), false, 128.0};
    const Measurement found = selftest::photon::many_photons(many_more, selftest::photon::build_gather(many_more));
    EXPECT_GT(found.curve.back().parameter, 2e6);
    EXPECT_LE(found.worst, case_of(many).bound) << found.where;
}

/// What --curves wrote before a mend: error by parameter.
std::map<double, double> curve_before(const std::string& name) {
    std::ifstream file(std::string(TRISTIM_SOURCE_DIR) + "/tests/stability/data/" + name + "-before.csv");
    std::map<double, double> curve;
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
        const std::size_t error = line.rfind(',');
        const std::size_t value = line.rfind(',', error - 1);
        curve[std::stod(line.substr(value + 1))] = std::stod(line.substr(error + 1));
    }
    return curve;
}

class PhotonStabilityCurve : public testing::TestWithParam<std::pair<const char*, const char*>> {};

/// The errors that were beyond the bound before are below it today, all along.
TEST_P(PhotonStabilityCurve, LiesBelowItsBound) {
    const auto& [file, name] = GetParam();
    const selftest::Case tested = case_of(name);
    const std::map<double, double> before = curve_before(file);
    ASSERT_GT(before.size(), 5U);
    double worst = 0.0;
    for (const auto& [parameter, error] : before)
        worst = std::max(worst, error);
    EXPECT_GT(worst, tested.bound) << "the old curve shows no fault";
    const Measurement today = tested.measure(setting());
    ASSERT_GT(today.curve.size(), 5U);
    for (const selftest::CurvePoint& point : today.curve)
        EXPECT_LE(point.error, tested.bound) << tested.parameter << " " << point.parameter;
}

INSTANTIATE_TEST_SUITE_P(Before, PhotonStabilityCurve,
                         testing::Values(std::pair("photon-many_photons", many), std::pair("photon-density", dense),
                                         std::pair("photon-radius_schedule", schedule),
                                         std::pair("accumulation-statistics_radius", statistics)),
                         [](const auto& curve) {
                             std::string name = curve.param.first;
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

} // namespace
} // namespace tristim::test::photon_faults_test
