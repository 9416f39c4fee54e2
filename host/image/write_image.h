#pragma once

#include "image/image.h"
#include "image/tone_mapping.h"

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace tristim {

/// What the three channels of an EXR file hold.
enum class ColourSpace {
    Srgb,   ///< R, G, B: linear, Rec.709 primaries, D65 white; negative outside of the gamut
    CieXyz, ///< X, Y, Z
};

/// Names and values, in order. In the EXR header each name gets the prefix "tristim:".
using ImageMetadata = std::vector<std::pair<std::string, std::variant<std::string, double, std::int64_t>>>;

/// Throws Error if an image cannot be written at `path`: its extension is neither .exr nor .png, its folder is missing
/// or not writable, or something other than a writable file stands there. Changes nothing.
void check_writable(const std::string& path);

/// Writes float32 channels, nothing clamped. The data window is the image's region, the display window the whole image.
/// OpenEXR has no 64-bit integers: an integer beyond 32 bits becomes a string of its digits. The file is replaced as a
/// whole or not at all. Throws Error.
void write_exr(const std::string& path, const XyzImage& image, ColourSpace space, const ImageMetadata& metadata);

/// Writes the image's region in 8-bit sRGB. The file is replaced as a whole or not at all. Throws Error.
void write_png(const std::string& path, const XyzImage& image, const ToneMapping& tone_mapping);

} // namespace tristim
