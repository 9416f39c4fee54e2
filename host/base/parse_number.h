#pragma once

#include <charconv>
#include <optional>
#include <string_view>

namespace tristim {

/// The number that is all of the text, in the C locale's notation ("1e3", "inf"), else none.
template <typename Number = double>
std::optional<Number> parse_number(std::string_view text) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size())
        return std::nullopt;
    return value;
}

} // namespace tristim
