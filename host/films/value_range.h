#pragma once

#include <string>
#include <vector>

namespace tristim {

/// The most values that a range may have.
inline constexpr double max_range_values = 1e6;

/// "FIRST:LAST:STEP", the values FIRST, FIRST + STEP, … up to LAST, or the one value "VALUE". Throws Error, with `what`
/// ("wavelength") for the quantity, unless they are finite numbers with FIRST <= LAST, STEP > 0 and not too many.
std::vector<double> parse_range(const std::string& text, const std::string& what);

} // namespace tristim
