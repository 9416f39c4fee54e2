#pragma once

#include "image/image.h"
#include "spectra/colour.h"

#include <span>
#include <string>
#include <vector>

namespace tristim {

/// An error map shows each pixel's error on a logarithmic scale of this many decades: its brightest colour stands for
/// errors of the map's scale and above, its darkest one for those 10^-error_map_decades times as large and below.
inline constexpr double error_map_decades = 3.0;

/// Per pixel, in rows from the top: sqrt(mean of (a-b)² over X, Y, Z), in units of XYZ. Throws Error unless both images
/// have the same size and region.
std::vector<float> pixel_errors(const XyzImage& image, const XyzImage& reference);

/// One scale for error maps that are to be compared: the 99th percentile of all finite errors above zero, so that no
/// single pixel sets it, rounded up to 1, 2 or 5 times a power of ten. 0 if there is no such error.
double error_map_scale(std::span<const std::vector<float>> maps);

/// Position on the colour scale, 0 to 1: 1 + log10(error / scale) / error_map_decades, clamped. 0 for no error, 1 for
/// one that is not finite.
double error_map_position(double error, double scale);

/// The colour of a position, clamped to [0, 1], from black over blue, green and pink to white, in sRGB (gamma-encoded,
/// [0, 1]): Green, "A colour scheme for the display of astronomical intensity images", 2011, equation 2 with the
/// paper's start colour 0.5, -1.5 rotations, hue 1 and γ = 1. Its perceived brightness rises with the position.
Rgb error_map_colour(double position);

/// Writes the errors' colours as an 8-bit PNG, which is replaced as a whole or not at all. Throws Error unless both
/// images have the same size and region, or if the file cannot be written.
void write_error_map(const std::string& png_path, const XyzImage& image, const XyzImage& reference, double scale);

} // namespace tristim
