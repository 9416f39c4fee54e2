#pragma once

#include "spectra/colour.h"

#include <vector>

namespace tristim {

/// Fixed wavelengths and weights: XYZ = Σ_i weights[i] L(wavelengths[i]), where a constant spectrum 1 has Y = 1.
struct QuadratureRule {
    std::vector<double> wavelengths; ///< in nm, ascending
    std::vector<Xyz> weights;        ///< of the same length; some are negative
};

/// The counts of wavelengths that gauss_rule() derives.
inline constexpr int gauss_wavelengths_min = 4;
inline constexpr int gauss_wavelengths_max = 7;

/// The rule of G. W. Meyer, "Wavelength selection for synthetic image generation", CVGIP 41 (1988) 57–79: Gaussian
/// quadrature of each channel of the opponent space AC1C2, whose nodes the channels share where they lie close. Derived
/// from cie_bins(); 4 wavelengths are Meyer's own. It integrates constants exactly and smooth spectra well, but it is
/// biased: it does not see what lies between its wavelengths. Throws Error for other counts than those above.
QuadratureRule gauss_rule(int wavelengths);

} // namespace tristim
