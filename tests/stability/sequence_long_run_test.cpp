// Long runs of the sequences: where a pass's wavelengths lie, which of them a camera path keeps and the numbers of
// photon and camera paths share nothing. A known fault of renderers, noise that repeats over buckets of wavelengths, is
// such a dependence; the tests below see it when it is put in.
#include "kernel_harness.h"
#include "render/sobol.h"
#include "selftest/selftest.h"
#include "selftest/sequence_cases.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace tristim::test::long_run_test {
namespace {

using namespace kernel_test;
using selftest::dependence_bound;
using selftest::LongRun;
using selftest::PairCounts;
using selftest::PassNumbers;

/// The source with every `from` put as `to`; fails if there is none.
std::string with_change(std::string source, const std::string& from, const std::string& to) {
    std::size_t at = source.find(from);
    EXPECT_NE(at, std::string::npos) << "the kernels no longer say " << from;
    for (; at != std::string::npos; at = source.find(from, at + to.size()))
        source.replace(at, from.size(), to);
    return source;
}

/// The cases' names whose bound a change to kernels/selftest/sequence.cl breaks.
std::vector<std::string> broken_by(const std::string& from, const std::string& to) {
    const std::string source = with_change(flatten_kernel_source("selftest/sequence.cl"), from, to);
    const auto cores = [&](const selftest::Setting&) { return build_test_program(source); };
    std::vector<std::string> broken;
    for (const selftest::Case& c : selftest::sequence_cases(cores)) {
        const selftest::Outcome outcome = selftest::run(c, {test_device(), false, 0.25});
        EXPECT_EQ(outcome.failure, "") << c.name;
        if (!outcome.passed())
            broken.push_back(c.name);
    }
    return broken;
}

constexpr const char* photons_case = "wavelengths against photons over passes";
constexpr const char* pixels_case = "wavelengths against pixels over passes";
constexpr const char* places_case = "places of wavelengths, passes to 2^32";

TEST(SequenceStability, DependentWavelengthsAreCaught) {
    using Names = std::vector<std::string>;
    EXPECT_EQ(broken_by("? last[k] : 0u", "? last[k] : 0u"), Names{}) << "without any change";
    // The wavelengths take a dimension that paths have: van der Corput's, the first.
    EXPECT_EQ(broken_by("? last[k] : 0u", "? 1u << (31u - bit) : 0u"), (Names{places_case, photons_case, pixels_case}));
    // They begin anew after 64 passes.
    EXPECT_EQ(broken_by("x ^= pass >> bit & 1u", "x ^= (pass & 63u) >> bit & 1u"),
              (Names{places_case, photons_case, pixels_case}));
}

TEST(SequenceStability, InexactSequencesAreCaught) {
    using Names = std::vector<std::string>;
    const std::string in_float =
        "convert_uint_sat(((float)j + pass_position(seed, pass, 0u) * 0x1p-32f) / n * 0x1p32f)";
    EXPECT_EQ(broken_by("(uint)(((ulong)j << 32 | pass_position(seed, pass, 0u)) / n)", in_float), Names{places_case});
}

/// A million passes, for a photon path among so many: 64 by 64 cells of 256 pairs. The third seed is that of
/// wavelengths with --sequence random.
TEST(SequenceStability, AMillionPassesOfWavelengthsAndPathsAreIndependent) {
    const auto program = [](const char* random) {
        return build_test_program(flatten_kernel_source("selftest/sequence.cl"), {{"SEQUENCE_RANDOM", random}});
    };
    const ::cl::Program stratified = program("0"), random = program("1");
    constexpr std::size_t cells = 64;
    constexpr double bound = 3.0; // random pairs are within 0.13 of 1, these were found to reach 1.06
    double largest = 0.0;
    for (const std::uint32_t seed : {0U, 1U, 2U}) {
        for (const std::uint32_t paths : {1U, 1024U, 60000U, 65536U}) {
            const LongRun run{seed, 0, paths, paths / 5U, 123456U + seed, std::size_t{1} << 20U};
            const std::vector<PassNumbers> numbers = pass_numbers(test_device(), seed == 2U ? random : stratified, run);
            for (std::size_t d = 0; d < 8; ++d) {
                PairCounts photon(cells, cells), part(cells, cells), eye(cells, cells);
                for (const PassNumbers& pass : numbers) {
                    photon.add(pass.wavelengths, pass.photon[d]);
                    const double in_parts = double{pass.photon[d]} * paths;
                    part.add(pass.wavelengths, in_parts - std::floor(in_parts));
                    eye.add(pass.wavelengths, pass.eye[d]);
                }
                for (const PairCounts* counts : {&photon, &part, &eye}) {
                    largest = std::max(largest, counts->dependence());
                    EXPECT_LT(counts->dependence(), bound)
                        << "seed " << seed << ", " << paths << " paths a pass, dimension " << d;
                }
            }
        }
    }
    RecordProperty("largest_dependence", fmt::format("{:.2f}", largest));
}

/// χ² of independence itself, on pairs that are known to be independent, or not.
TEST(SequenceStability, DependenceOfPairsIsMeasured) {
    kernel_test::Random random(3);
    PairCounts independent(16, 16), same(16, 16), slightly(16, 16), uneven(16, 16), one_row(16, 16);
    for (int i = 0; i < 100000; ++i) {
        const double x = random(), y = random();
        independent.add(x, y);
        same.add(x, x);
        slightly.add(x, i % 10 == 0 ? x : y);
        uneven.add(x * x, y * y * y);
        one_row.add(x, 0.3);
    }
    EXPECT_NEAR(independent.dependence(), 1.0, 0.6); // six standard deviations of χ² with 225 degrees of freedom
    EXPECT_NEAR(uneven.dependence(), 1.0, 0.6);
    EXPECT_EQ(one_row.dependence(), 0.0);
    EXPECT_GT(same.dependence(), 100.0);
    EXPECT_GT(slightly.dependence(), 5.0 * dependence_bound);
}

} // namespace
} // namespace tristim::test::long_run_test
