// kernels/multiply_add.h as devices without a fused multiply-add compile it, and kernels/loops.h.

#include "kernel_harness.h"
#include "shared_types.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace tristim {
namespace {

using namespace kernel_test;

/// Lane 0 of a float, lane 2 of a float3 and lane 7 of a float8 are the functions that the kernels call most.
const char* const multiply_add_source = R"(
#include "multiply_add.h"
kernel void fused(const global float4* in, global float4* out) {
    const float4 x = in[get_global_id(0)];
    const float3 three = fused_multiply_add((float3)(1.0f, 1.0f, x.x), (float3)(1.0f, 1.0f, x.y), (float3)(1.0f, 1.0f, x.z));
    const float8 eight = fused_multiply_add((float8)(x.x), (float8)(x.y), (float8)(x.z));
    out[get_global_id(0)] = (float4)(fused_multiply_add(x.x, x.y, x.z), three.z, eight.s7, 0.0f);
}
)";

std::vector<cl_float4> fused(const std::vector<cl_float4>& inputs) {
    const Buffer<cl_float4> out = make_buffer<cl_float4>(inputs.size());
    run(build_test_program(multiply_add_source, {{"HAS_FMA", "0"}}), "fused", inputs.size(), upload(inputs), out);
    return out.read(test_device());
}

TEST(KernelMultiplyAdd, ProductsErrorIsExact) {
    Random random(11);
    std::vector<cl_float4> inputs;
    for (int i = 0; i < 20000; ++i) {
        const float a = std::ldexp(1.0F + random(), i % 40 - 20) * (i % 2 == 0 ? 1.0F : -1.0F);
        const float b = i % 3 == 0 ? a : std::ldexp(1.0F + random(), i % 31 - 15);
        inputs.push_back({{a, b, -(a * b), 0.0F}});
    }
    // Halves that round up to the next power of two, and a product at the end of the range.
    inputs.push_back({{std::nextafter(2.0F, 0.0F), std::nextafter(4.0F, 0.0F), -8.0F, 0.0F}});
    inputs.push_back({{0x1.fffffep62F, 0x1.fffffep62F, -0x1.fffffcp125F, 0.0F}});
    const std::vector<cl_float4> out = fused(inputs);
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        const auto [a, b, c, unused] = inputs[i].s;
        for (const int function : {0, 1, 2})
            ASSERT_EQ(out[i].s[function], std::fma(a, b, c)) << a << " * " << b << " + " << c;
    }
}

/// Where nothing cancels: the sum rounds twice.
TEST(KernelMultiplyAdd, RoundsTwiceAtMost) {
    Random random(12);
    std::vector<cl_float4> inputs;
    for (int i = 0; i < 20000; ++i)
        inputs.push_back({{1.0F + random(), 1.0F + random(), std::ldexp(1.0F + random(), i % 40 - 20), 0.0F}});
    const std::vector<cl_float4> out = fused(inputs);
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        const double exact = double{inputs[i].s[0]} * inputs[i].s[1] + inputs[i].s[2];
        for (const int function : {0, 1, 2})
            ASSERT_NEAR(out[i].s[function], exact, 2.0 * unit_roundoff * exact) << i;
    }
}

TEST(KernelMultiplyAdd, KeepsInfinity) {
    for (const cl_float4& found : fused({{{3e38F, 10.0F, 1.0F, 0.0F}}, {{INFINITY, 2.0F, 1.0F, 0.0F}}})) {
        for (const int function : {0, 1, 2})
            EXPECT_EQ(found.s[function], INFINITY);
    }
}

/// A device may end loops early (tests/backends_test.cpp asks llvmpipe): who was cut short is counted, nobody else.
TEST(KernelLoops, CountsThoseThatWereCut) {
    const ::cl::Program program = build_test_program(R"(
#include "loops.h"
kernel void steps(uint outer, uint inner, global uint* taken, global uint* counts) {
    uint n = 0;
    for (uint i = 0; i < outer; ++i)
        for (uint j = 0; j < inner; ++j)
            n += 1u + (n >> 31);
    taken[get_global_id(0)] = n;
    count_cut_loops(counts);
}
)",
                                                     {{"LOOPS_END_EARLY", "1"}});
    constexpr std::size_t items = 16;
    for (const cl_uint inner : {1U, 100U, 200U, 400U}) {
        constexpr cl_uint outer = 300;
        const Buffer<cl_uint> taken = make_buffer<cl_uint>(items);
        const Buffer<cl_uint> counts = upload(std::vector<cl_uint>(2 * NON_FINITE_COUNTS, 0U));
        run(program, "steps", items, outer, inner, taken, counts);
        const std::vector<cl_uint> steps = taken.read(test_device());
        const auto cut = std::count_if(steps.begin(), steps.end(), [&](cl_uint n) { return n < outer * inner; });
        EXPECT_EQ(counts.read(test_device())[2 * CUT_LOOPS], static_cast<cl_uint>(cut)) << inner;
    }
}

} // namespace
} // namespace tristim
