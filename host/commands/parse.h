#pragma once

#include <array>
#include <string>

namespace tristim {

/// "WxH" with positive integers. Throws Error otherwise.
std::array<int, 2> parse_resolution(const std::string& text);

} // namespace tristim
