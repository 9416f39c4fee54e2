#pragma once

#include "spectra/spectrum.h"

#include <string>

namespace tristim {

/// A light and its name.
struct Illuminant {
    std::string name; ///< in full, "stdillum-D65", or a file's
    Spectrum spectrum;
};

/// A named illuminant, with or without its prefix ("stdillum-D65", "D65", "mercury"), or a .spd file. Throws Error
/// naming near matches if unknown, and for a file that is negative somewhere or dark at all visible wavelengths.
Illuminant find_illuminant(const std::string& name);

} // namespace tristim
