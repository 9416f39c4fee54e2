#pragma once

#include <CLI/CLI.hpp>

#include <array>
#include <string>

namespace tristim {

/// "WxH" with positive integers, or "P%" of `own` with a positive number, rounded to at least one pixel. Throws Error
/// otherwise.
std::array<int, 2> parse_resolution(const std::string& text, const std::array<int, 2>& own);

/// For options whose value must not be empty, as one is from a script's variable that was never set.
CLI::Validator not_empty();

/// Throws Error, which names the option, unless it was given a positive, finite number of seconds.
void check_seconds(double seconds, const std::string& option);

} // namespace tristim
