#pragma once

#include "selftest/film_points.h"

namespace tristim::selftest {

/// film_cases() with kernels from another source, for tests that a fault is found.
std::vector<Case> film_cases(FilmKernels::Builder builder);

} // namespace tristim::selftest
