#pragma once

#include <cstdint>
#include <vector>

namespace tristim {

/// Dimensions of the Sobol' sequence that the kernels use at once (sobol8 of kernels/rng.h).
inline constexpr int sobol_dimensions = 8;

/// The Sobol' direction numbers v_1 … v_32 of a dimension, most significant bit first: Joe & Kuo 2008, "Constructing
/// Sobol sequences with better two-dimensional projections", table new-joe-kuo-6.
std::vector<std::uint32_t> sobol_direction_numbers(int dimension);

/// For kernels/rng.h: [byte of the index][value of the byte][dimension] → xor of the direction numbers, bit-reversed.
std::vector<std::uint32_t> sobol_table();

} // namespace tristim
