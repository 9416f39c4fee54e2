#pragma once

#include "spectra/spectrum.h"

#include <array>

namespace tristim {

using Xyz = std::array<double, 3>;
using Rgb = std::array<double, 3>;
using Matrix3 = std::array<std::array<double, 3>, 3>;

/// CIE 1931 2° colour matching functions x̄, ȳ, z̄ averaged over the 400 bins [380+i, 381+i) nm (1 nm table of CIE
/// 018:2019, linear between samples).
const std::array<WavelengthBins, 3>& cie_bins();

/// k = ∫ȳ dλ over 380–780 nm in nm, the denominator of the paper's equations 2–4.
double cie_y_integral();

/// The paper's equations 2–4: XYZ = (1/k) ∫ L f dλ over 380–780 nm. A constant spectrum 1 has Y = 1.
Xyz spectrum_to_xyz(const Spectrum& spectrum);

/// Linear sRGB / Rec.709 (IEC 61966-2-1 primaries, D65 white) from XYZ and back (the paper's equation 5).
const Matrix3& xyz_to_rgb_matrix();
const Matrix3& rgb_to_xyz_matrix();
Rgb xyz_to_rgb(const Xyz& xyz);
Xyz rgb_to_xyz(const Rgb& rgb);

/// Linear RGB of the sRGB primaries but of another white to XYZ; the white's Y is that of RGB (1, 1, 1).
Matrix3 rgb_to_xyz_matrix(const Xyz& white);

} // namespace tristim
