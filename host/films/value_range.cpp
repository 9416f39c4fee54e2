#include "films/value_range.h"

#include "base/error.h"
#include "base/parse_number.h"

#include <algorithm>
#include <cmath>

namespace tristim {

std::vector<double> parse_range(const std::string& text, const std::string& what) {
    std::vector<double> numbers;
    for (std::size_t begin = 0;;) {
        const std::size_t colon = text.find(':', begin);
        const auto number =
            parse_number(std::string_view(text).substr(begin, colon == text.npos ? colon : colon - begin));
        if (!number || !std::isfinite(*number))
            fail("bad {} \"{}\": expected a finite number or FIRST:LAST:STEP", what, text);
        numbers.push_back(*number);
        if (colon == text.npos)
            break;
        begin = colon + 1;
    }
    if (numbers.size() == 1)
        return numbers;
    if (numbers.size() != 3)
        fail("bad {} \"{}\": expected one number or three, FIRST:LAST:STEP", what, text);
    const double first = numbers[0], last = numbers[1], step = numbers[2];
    if (!(step > 0.0))
        fail("bad {} \"{}\": the step must be positive", what, text);
    if (last < first)
        fail("bad {} \"{}\": the last value is below the first", what, text);
    // A last value that rounding puts just below LAST counts.
    const double steps = std::floor((last - first) / step * (1.0 + 1e-12) + 1e-9);
    if (!(steps < max_range_values))
        fail("bad {} \"{}\": more than {:.0f} values", what, text, max_range_values);
    std::vector<double> values;
    for (std::size_t i = 0; i <= static_cast<std::size_t>(steps); ++i)
        values.push_back(std::min(first + static_cast<double>(i) * step, last));
    return values;
}

} // namespace tristim
