#pragma once

namespace tristim {

/// Number k of the series …, 0.5, 1 (k = 0), 2, 5, 10, …
double round_number(int k);

/// The k of the first number of the series at or above a positive value.
int round_number_above(double value);

} // namespace tristim
