#pragma once

// The optics cases, file by file, for a program of the caller's: so that tests can see a case catch a fault.

#include "selftest/case.h"
#include "selftest/optics_oracle.h"

#include <random>

namespace tristim::selftest {

/// Of kernels/selftest/optics.cl, the last of optics_paths.cl.
std::vector<Case> fresnel_cases(const Programs& cores);
std::vector<Case> direction_cases(const Programs& cores);
std::vector<Case> microfacet_cases(const Programs& cores);
std::vector<Case> path_cases(const Programs& paths);

/// The macros of kernels/selftest/optics.cl and optics_paths.cl.
Macros optics_macros();
Macros path_macros();

namespace optics {

/// Runs a kernel on inputs of `per_input` float4 each and gives `per_output` for each. `before` are the kernel's
/// arguments ahead of those two buffers.
std::vector<cl_float4> run(const Setting& setting, const ::cl::Program& program, const char* kernel,
                           std::vector<cl_float4> inputs, std::size_t per_input, std::size_t per_output,
                           const std::vector<::cl::Buffer>& before = {});

/// Uniform random numbers and directions for inputs.
class Random {
  public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}
    double operator()() { return static_cast<double>(engine_()) * 0x1p-32; }
    /// A multiple of 2^-24 in [0, 1), as the kernels draw them.
    float unit_float() { return static_cast<float>(engine_() >> 8) * 0x1p-24F; }
    Vector direction();

  private:
    std::mt19937 engine_;
};

cl_float4 float4_of(const Vector& v, double w = 0.0);
cl_float4 float4_of(double x, double y, double z = 0.0, double w = 0.0);
Vector vector_of(const cl_float4& v);

/// first … last in `count` steps of equal ratio, rounded to float.
std::vector<float> ratio_steps(double first, double last, int count);

/// Cosines from normal to grazing: 1, …, 1e-8 and 0.
std::vector<float> cosines();

/// Indices n_t/n_i of 0.1 to 10 and, on both sides of 1, those off by 1e-7 to 0.1, and 1 itself.
std::vector<float> relative_indices();

} // namespace optics
} // namespace tristim::selftest
