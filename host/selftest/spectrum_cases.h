#pragma once

#include "selftest/case.h"

#include <functional>
#include <vector>

namespace tristim::selftest {

/// Gives the program of kernels/selftest/spectrum.cl for a setting.
using SpectrumCores = std::function<::cl::Program(const Setting&)>;

/// The spectrum cases for a program of the caller's: so that tests can see a case catch a fault.
std::vector<Case> spectrum_cases(const SpectrumCores& cores);

/// The macros of kernels/selftest/spectrum.cl.
Macros spectrum_macros();

} // namespace tristim::selftest
