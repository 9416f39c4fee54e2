// The optics cases catch faults: each of these, put into the kernels' source, must fail the case named.
#include "kernel_harness.h"
#include "selftest/optics_cases.h"
#include "selftest/selftest.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace tristim::test {
namespace {

using namespace selftest;

struct Fault {
    const char* name;
    const char* file; ///< of kernels/selftest/
    const char* original;
    const char* replacement;
    const char* caught_by;
};

const std::vector<Fault> faults{
    {"cosine_of_refraction_from_the_sine", "optics.cl",
     "return cos_i * cos_i + (1.0f - inverse_eta) * (1.0f + inverse_eta) * sin2_i;",
     "return 1.0f - sin2_i * inverse_eta * inverse_eta;", "entering at cosines of 1 to 1e-8"},
    {"half_polarised", "optics.cl", "(sum * sum + difference * difference)", "(2.0f * sum * sum)",
     "reflectance, eta 0.1 to 10"},
    {"reflectance_by_cancellation", "optics.cl", "const float ratio = (1.0f - inverse_eta) * (1.0f + inverse_eta)",
     "const float ratio = (*cos_t - inverse_eta * cos_i) * b", "reflectance, eta 1 and 1 ± 1e-7 to 1 ± 0.1"},
    {"absorption_by_cancellation", "optics.cl", "difference >= 0.0f ? larger : eta * k / larger",
     "sqrt(max(0.5f * (modulus + difference), (type)(0.0f)))", "conductors, n 0.01 to 10, k 0 to 100"},
    {"bent_too_far", "optics.cl", "(inverse_eta * cos_i - cos_t) * n", "(inverse_eta * cos_i - 1.00001f * cos_t) * n",
     "their length"},
    {"frame_without_its_other_half", "optics.cl", "const float sign = copysign(1.0f, n.z);", "const float sign = 1.0f;",
     "frames, n.z -1 to 1"},
    {"octahedron_not_folded", "optics.cl",
     "if (n.z < 0.0f)\n        p = ", "if (n.z < -2.0f)\n        p = ", "packed normals"},
    {"poles_of_the_sphere", "optics.cl", "(1.0f - cosine) * (1.0f + cosine))", "1.0f - cosine)",
     "maps of the unit square, u 0 to 1 - 2^-24"},
    {"masking_of_one_direction", "optics.cl", "fabs(wo.z) * ggx_stretched_length(wi, alpha)", "fabs(wo.z * wi.z)",
     "rough weights, alpha 1e-4 to 1"},
    {"no_weight_of_the_slots", "optics_paths.cl", "weight->scale *= (float)W;", "",
     "dispersive glass, critical angles"},
    {"weight_not_divided_by_its_chance", "optics_paths.cl",
     "multiply_weight(weight, &optics.transmitted, 1.0f / (1.0f - probability));",
     "multiply_weight(weight, &optics.transmitted, 1.0f);", "films that evanesce at some wavelengths"}};

class OpticsFault : public testing::TestWithParam<Fault> {};

TEST_P(OpticsFault, IsCaught) {
    const Fault& fault = GetParam();
    const bool of_paths = std::string(fault.file) == "optics_paths.cl";
    std::string text = flatten_kernel_source(std::string("selftest/") + fault.file);
    const auto at = text.find(fault.original);
    ASSERT_NE(at, std::string::npos) << "the kernels no longer say: " << fault.original;
    const auto caught = [&](const std::string& source) {
        const Programs cores = [&](const Setting& setting) {
            return build_program_from_text(setting.device, "optics-fault.cl", source,
                                           of_paths ? path_macros() : optics_macros(), {setting.fast_math, {}});
        };
        std::vector<Case> cases = of_paths ? path_cases(cores) : fresnel_cases(cores);
        for (const auto& more : {direction_cases(cores), microfacet_cases(cores)}) {
            if (!of_paths)
                cases.insert(cases.end(), more.begin(), more.end());
        }
        const auto found = std::find_if(cases.begin(), cases.end(),
                                        [&](const Case& c) { return std::string(c.name) == fault.caught_by; });
        EXPECT_NE(found, cases.end()) << "there is no case " << fault.caught_by;
        const Outcome outcome = selftest::run(*found, {kernel_test::test_device(), false, 0.1});
        EXPECT_EQ(outcome.failure, "");
        return !outcome.passed();
    };
    EXPECT_FALSE(caught(text)) << "without the fault";
    text.replace(at, std::string(fault.original).size(), fault.replacement);
    EXPECT_TRUE(caught(text));
}

INSTANTIATE_TEST_SUITE_P(OpticsStability, OpticsFault, testing::ValuesIn(faults),
                         [](const auto& test) { return test.param.name; });

} // namespace
} // namespace tristim::test
