#pragma once

#include "selftest/case.h"

#include <vector>

namespace tristim::selftest {

/// The spectrum cases for a program of kernels/selftest/spectrum.cl that is the caller's: so that tests can see a case
/// catch a fault.
std::vector<Case> spectrum_cases(const Programs& cores);

/// The macros of kernels/selftest/spectrum.cl.
Macros spectrum_macros();

} // namespace tristim::selftest
