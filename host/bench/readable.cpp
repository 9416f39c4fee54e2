#include "bench/readable.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace tristim {
namespace {

void trim_zeros(std::string& number) {
    if (number.find('.') == std::string::npos)
        return;
    number.erase(number.find_last_not_of('0') + 1);
    if (number.back() == '.')
        number.pop_back();
}

} // namespace

std::string readable_number(double value, int digits) {
    if (value == 0.0 || !std::isfinite(value))
        return fmt::format("{}", value);
    // The exponent after rounding: 9.96 is 10 to two digits.
    const std::string scientific = fmt::format("{:.{}e}", value, digits - 1);
    const std::size_t e = scientific.find('e');
    const int exponent = std::stoi(scientific.substr(e + 1));
    std::string mantissa = scientific.substr(0, e);
    if (exponent < -4 || exponent > 6) {
        trim_zeros(mantissa);
        return fmt::format("{}e{}", mantissa, exponent);
    }
    std::string number = fmt::format("{:.{}f}", std::stod(scientific), std::max(0, digits - 1 - exponent));
    trim_zeros(number);
    return number;
}

std::string readable_seconds(double seconds) {
    const auto in_unit = [](double value, const char* unit) {
        return fmt::format("{} {}", readable_number(value, value < 99.5 ? 2 : 3), unit);
    };
    if (seconds < 0.0995)
        return in_unit(1e3 * seconds, "ms");
    if (seconds < 119.5)
        return in_unit(seconds, "s");
    if (seconds < 119.5 * 60.0)
        return in_unit(seconds / 60.0, "min");
    if (seconds < 47.5 * 3600.0)
        return in_unit(seconds / 3600.0, "h");
    return in_unit(seconds / 86400.0, "days");
}

std::string readable_less(double ratio) {
    if (ratio >= least_readable_factor)
        return fmt::format("{} times less than", readable_number(ratio));
    const double percent = 100.0 * (1.0 - 1.0 / ratio);
    return percent < 1.0 ? "less than 1 % below" : fmt::format("{} % less than", readable_number(percent));
}

std::string readable_more(double ratio) {
    if (ratio >= least_readable_factor)
        return fmt::format("{} times as much as", readable_number(ratio));
    const double percent = 100.0 * (ratio - 1.0);
    return percent < 1.0 ? "less than 1 % above" : fmt::format("{} % more than", readable_number(percent));
}

std::string readable_list(const std::vector<std::string>& items) {
    std::string text;
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (i > 0)
            text += i + 1 == items.size() ? " and " : ", ";
        text += items[i];
    }
    return text;
}

} // namespace tristim
