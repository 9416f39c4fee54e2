#pragma once

#include "spectra/colour.h"
#include "spectra/spectrum.h"

#include <string>
#include <string_view>
#include <vector>

namespace tristim {

/// The names by which users know the forms of RgbUpsampling: "jakob-hanika" and "meng".
std::vector<std::string> rgb_upsampling_names();

/// Throws Error naming the forms there are for any other name.
RgbUpsampling parse_rgb_upsampling(std::string_view name);

/// The spectrum of a reflectance under D65 as a colour, by what the renderer sums: bin means of illuminant, reflectance
/// and colour matching functions.
struct D65Colour {
    /// XYZ of a reflectance that is linear between 380, 381, …, 780 nm, by its value at each; equal to the bins' sum.
    std::array<Xyz, lambda_bins + 1> weights{};
    Xyz white{};          ///< XYZ of the reflectance 1
    Matrix3 rgb_to_xyz{}; ///< linear sRGB to XYZ with that white, so that (1, 1, 1) is the reflectance 1
};
const D65Colour& d65_colour();

/// The reflectance of a linear sRGB colour in [0, 1]³, not grey, which the caller has checked: it has the colour under
/// D65 and is sampled every 1 nm from 360 to 830 nm. See the two files.
Spectrum jakob_hanika_reflectance(const Rgb& rgb);
Spectrum meng_reflectance(const Rgb& rgb);

} // namespace tristim
