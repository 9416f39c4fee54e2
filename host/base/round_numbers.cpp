#include "base/round_numbers.h"

#include <array>
#include <cmath>

namespace tristim {

double round_number(int k) {
    const int exponent = static_cast<int>(std::floor(k / 3.0));
    const double mantissa = std::array{1.0, 2.0, 5.0}[static_cast<std::size_t>(k - 3 * exponent)];
    // Powers of ten up to 22 are exact and division rounds right, so that 0.002 prints as such.
    return exponent < 0 ? mantissa / std::pow(10.0, -exponent) : mantissa * std::pow(10.0, exponent);
}

int round_number_above(double value) {
    int k = 3 * static_cast<int>(std::floor(std::log10(value))) - 1;
    while (round_number(k) < value)
        ++k;
    return k;
}

} // namespace tristim
