#pragma once

#include "spectra/colour.h"
#include "spectra/spectrum.h"

namespace tristim {

/// The reflectance of a linear sRGB colour in [0, 1]³, which the caller has checked: constant if the colour is grey,
/// else the sigmoid of a quadratic polynomial (Jakob & Hanika 2019) that has the colour under D65.
Spectrum fitted_reflectance(const Rgb& rgb);

} // namespace tristim
