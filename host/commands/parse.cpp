#include "commands/parse.h"

#include "base/error.h"

#include <charconv>

namespace tristim {

std::array<int, 2> parse_resolution(const std::string& text) {
    std::array<int, 2> size{};
    const char* const end = text.data() + text.size();
    const auto width = std::from_chars(text.data(), end, size[0]);
    if (width.ec == std::errc() && width.ptr != end && *width.ptr == 'x') {
        const auto height = std::from_chars(width.ptr + 1, end, size[1]);
        if (height.ec == std::errc() && height.ptr == end && size[0] > 0 && size[1] > 0)
            return size;
    }
    fail("bad resolution '{}': expected WIDTHxHEIGHT with positive integers, such as 640x480", text);
}

} // namespace tristim
