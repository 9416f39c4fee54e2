#pragma once

#include "spectra/spectrum.h"

#include <string>
#include <string_view>

namespace tristim {

/// The spectrum of a .spd file's text: pairs "lambda value", wavelengths in nm, separated by white space; '#' starts a
/// comment. `name` stands for the file in errors. Throws Error with name and line for what is not a finite number, for
/// an odd count of numbers, for wavelengths that do not ascend, and for a text without numbers.
Spectrum parse_spd(std::string_view text, const std::string& name);

} // namespace tristim
