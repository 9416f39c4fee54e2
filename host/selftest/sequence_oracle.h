#pragma once

#include <cstdint>

namespace tristim::selftest {

/// Where the wavelengths of a pass lie with the stratified sequence, as a binary fraction: the ninth dimension of the
/// Sobol' sequence of Joe & Kuo 2008, with a digital shift.
std::uint32_t wavelength_position(std::uint32_t seed, std::uint32_t pass);

/// The one pass of 2^32 whose wavelengths lie there.
std::uint32_t pass_of_wavelength_position(std::uint32_t seed, std::uint32_t position);

/// Part j of n at equal distances, (j + position)/n rounded down.
std::uint32_t rotated(std::uint32_t position, std::uint32_t j, std::uint32_t n);

} // namespace tristim::selftest
