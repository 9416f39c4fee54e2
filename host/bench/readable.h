#pragma once

#include <string>
#include <vector>

/// Quantities as a person reads them.

namespace tristim {

/// Rounded to so many significant digits, without trailing zeros: 0.0041, 12, 1200, 4.1e-6.
std::string readable_number(double value, int digits = 2);

/// A time span of two significant digits (three from 100 on): "50 ms", "2.5 s", "60 s", "12 min", "3.5 h",
/// "4 days".
std::string readable_seconds(double seconds);

/// Smaller factors read better in per cent; this one rounds to 1.1.
inline constexpr double least_readable_factor = 1.095;

/// How much less an error is than one `ratio` ≥ 1 times as great: "1.6 times less than", "4.8 % less than".
std::string readable_less(double ratio);

/// The same from the other side: "1.6 times as much as", "5 % more than".
std::string readable_more(double ratio);

/// "a", "a and b", "a, b and c".
std::string readable_list(const std::vector<std::string>& items);

} // namespace tristim
