#include "commands/parse.h"

#include "base/error.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace tristim {
namespace {

constexpr double largest_percent = 1e4;

} // namespace

std::array<int, 2> parse_resolution(const std::string& text, const std::array<int, 2>& own) {
    std::array<int, 2> size{};
    const char* const end = text.data() + text.size();
    double percent = 0.0;
    const auto share = std::from_chars(text.data(), end, percent);
    if (share.ec == std::errc() && share.ptr + 1 == end && *share.ptr == '%' && percent > 0.0 &&
        percent <= largest_percent) {
        for (std::size_t i = 0; i < size.size(); ++i)
            size[i] = std::max(1, static_cast<int>(std::lround(0.01 * percent * own[i])));
        return size;
    }
    const auto width = std::from_chars(text.data(), end, size[0]);
    if (width.ec == std::errc() && width.ptr != end && *width.ptr == 'x') {
        const auto height = std::from_chars(width.ptr + 1, end, size[1]);
        if (height.ec == std::errc() && height.ptr == end && size[0] > 0 && size[1] > 0)
            return size;
    }
    fail("bad resolution '{}': expected WIDTHxHEIGHT with positive integers, such as 640x480, or a share of the "
         "scene's own, such as 50%",
         text);
}

CLI::Validator not_empty() {
    return {[](const std::string& text) { return text.empty() ? std::string("its value is empty") : std::string(); },
            ""};
}

void check_seconds(double seconds, const std::string& option) {
    if (!(seconds > 0.0 && std::isfinite(seconds)))
        fail("{} must be a positive number of seconds", option);
}

} // namespace tristim
