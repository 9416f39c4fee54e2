// The wavelength that a camera path keeps behind dispersive surfaces, by eye_pass.cl's own two statements: over the
// passes it depends neither on where the pass's wavelengths lie nor on where in the pixel, on the light and on the lens
// the path goes.
#include "kernel_harness.h"
#include "render/sobol.h"
#include "selftest/sequence_cases.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace tristim::test {
namespace {

using namespace kernel_test;
using selftest::PairCounts;

/// Of χ² over its degrees of freedom (selftest/sequence_cases.h). For a pixel's 2^16 or 2^17 passes it was found to
/// reach 13, of W = 4 in the last passes before 2^32, where counts of 512 pairs to a cell scatter by 16 %; slots in
/// step with the passes make hundreds of it in an eighth of that.
constexpr double slot_bound = 20.0;

struct EyeNumbers {
    float slot, wavelengths;
    std::array<float, 8> path;
};

/// "const uint turn = …; const int slot = …;" of kernels/eye_pass.cl.
std::string slot_statements() {
    const std::string source = flatten_kernel_source("eye_pass.cl");
    const std::size_t first = source.find("const uint turn =");
    const std::size_t last = source.find(';', source.find("const int slot =", first));
    EXPECT_NE(first, std::string::npos);
    EXPECT_NE(last, std::string::npos);
    return source.substr(first, last - first + 1);
}

/// Pixels of consecutive numbers in passes of consecutive numbers, pass by pass.
class EyeSlotRun {
  public:
    EyeSlotRun(int w, const std::string& statements)
        : program_(build_test_program(R"(
#include "wavelength_sampling.h"
kernel void slots(const global uint* sobol_table, uint seed, uint first_pass, uint passes, uint first_pixel, global float* out) {
    const size_t i = get_global_id(0);
    const uint pass = first_pass + (uint)i % passes, image_pixel = first_pixel + (uint)i / passes;
    const uint8 scramble = (uint8)(pcg4d((uint4)(image_pixel, STREAM_EYE, 0u, seed)), pcg4d((uint4)(image_pixel, STREAM_EYE, 1u, seed)));
    )" + statements + R"(
    out[10 * i] = (float)slot;
    out[10 * i + 1] = unit_float(pass_position(seed, pass, 0u));
    vstore8(sobol8(sobol_table, pass, scramble), 0, out + 10 * i + 2);
}
)",
                                      {{"W", std::to_string(w)}})) {}

    std::vector<EyeNumbers> operator()(std::uint32_t first_pass, std::uint32_t passes, std::uint32_t first_pixel,
                                       std::uint32_t pixels) const {
        const Buffer<EyeNumbers> out = make_buffer<EyeNumbers>(std::size_t{passes} * pixels);
        run(program_, "slots", out.size(), table_, cl_uint{11}, first_pass, passes, first_pixel, out);
        return out.read(test_device());
    }

  private:
    static_assert(sizeof(EyeNumbers) == 10 * sizeof(float));
    ::cl::Program program_;
    Buffer<std::uint32_t> table_ = upload(sobol_table());
};

struct Dependence {
    double value = 0.0;
    std::string of;
    void add(const PairCounts& counts, const std::string& what) {
        if (counts.dependence() >= value) {
            value = counts.dependence();
            of = what;
        }
    }
};

constexpr std::size_t cells = 16;

/// Over the passes of a pixel, and the slot's place λ = (slot + v)/W among all wavelengths as well as the slot itself.
Dependence over_passes(int w, const std::vector<EyeNumbers>& numbers) {
    const std::size_t slots = std::min(static_cast<std::size_t>(w), cells);
    PairCounts place(slots, cells);
    for (const EyeNumbers& of : numbers)
        place.add((of.slot + 0.5) / w, of.wavelengths);
    Dependence found;
    found.add(place, fmt::format("W = {}: slot and the wavelengths' place", w));
    for (std::size_t d = 0; d < 8; ++d) {
        PairCounts slot(slots, cells), lambda(cells, cells);
        for (const EyeNumbers& of : numbers) {
            slot.add((of.slot + 0.5) / w, of.path[d]);
            lambda.add((double{of.slot} + of.wavelengths) / w, of.path[d]);
        }
        found.add(slot, fmt::format("W = {}: slot and dimension {}", w, d));
        found.add(lambda, fmt::format("W = {}: the slot's wavelength and dimension {}", w, d));
    }
    return found;
}

class SequenceStabilitySlots : public testing::TestWithParam<int> {};

TEST_P(SequenceStabilitySlots, AreIndependentOfPlacesAndPathsOverPasses) {
    const EyeSlotRun run(GetParam(), slot_statements());
    for (const std::uint32_t first : {0U, 1000000U, 0xffffffffU - 100000U}) {
        for (const std::uint32_t pixel : {1U, 777777U}) {
            const Dependence found = over_passes(GetParam(), run(first, 1U << 16U, pixel, 1));
            EXPECT_LT(found.value, slot_bound) << found.of << ", pixel " << pixel << " from pass " << first;
        }
    }
}

/// Among the pixels of one pass: the slot is a hash, and so is the scrambling of the numbers.
TEST_P(SequenceStabilitySlots, AreIndependentOfPathsOverPixels) {
    const EyeSlotRun run(GetParam(), slot_statements());
    const std::size_t slots = std::min(static_cast<std::size_t>(GetParam()), cells);
    for (const std::uint32_t pass : {0U, 1U, 12345U}) {
        const std::vector<EyeNumbers> numbers = run(pass, 1, 0, 1U << 18U);
        for (std::size_t d = 0; d < 8; ++d) {
            PairCounts counts(slots, cells);
            for (const EyeNumbers& of : numbers)
                counts.add((of.slot + 0.5) / GetParam(), of.path[d]);
            EXPECT_LT(counts.dependence(), slot_bound) << "pass " << pass << ", dimension " << d;
        }
        PairCounts neighbours(slots, slots);
        for (std::size_t i = 1; i < numbers.size(); ++i)
            neighbours.add((numbers[i - 1].slot + 0.5) / GetParam(), (numbers[i].slot + 0.5) / GetParam());
        EXPECT_LT(neighbours.dependence(), slot_bound) << "pass " << pass << ", neighbouring pixels";
    }
}

INSTANTIATE_TEST_SUITE_P(Wavelengths, SequenceStabilitySlots, testing::Values(1, 3, 4, 8, 16, 60, 64, 256, 400),
                         [](const auto& w) { return fmt::format("W{}", w.param); });

/// Slots that only count the passes go in step with the low digits of the pass, and so with the numbers of paths.
TEST(SequenceStability, SlotsInStepWithThePassesAreCaught) {
    std::string in_step = slot_statements();
    const std::string turn = "+ turn";
    const std::size_t at = in_step.find(turn);
    ASSERT_NE(at, std::string::npos);
    in_step.erase(at, turn.size());
    for (const int w : {4, 8, 16, 64}) {
        const Dependence found = over_passes(w, EyeSlotRun(w, in_step)(0, 1U << 14U, 1, 1));
        EXPECT_GT(found.value, 10.0 * slot_bound) << w;
    }
}

} // namespace
} // namespace tristim::test
