#pragma once

#include "spectra/colour.h"

#include <array>

namespace tristim::test {

/// CIE 1976 L*a*b*.
using Lab = std::array<double, 3>;

/// L*a*b* of a colour seen beside a white (CIE 15:2018, section 8.2.1).
Lab to_lab(const Xyz& xyz, const Xyz& white);

/// The CIE 1976 colour difference ΔE*ab: the distance in L*a*b*.
double delta_e_1976(const Lab& a, const Lab& b);

/// The CIEDE2000 colour difference ΔE00 with k_L = k_C = k_H = 1 (ISO/CIE 11664-6:2014; equations as numbered by
/// G. Sharma, W. Wu & E. N. Dalal, "The CIEDE2000 Color-Difference Formula: Implementation Notes, Supplementary Test
/// Data, and Mathematical Observations", Color Research and Application 30(1), 2005).
double delta_e_2000(const Lab& a, const Lab& b);

} // namespace tristim::test
