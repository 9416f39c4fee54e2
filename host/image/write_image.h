#pragma once

#include "image/image.h"
#include "image/tone_mapping.h"

#include <array>
#include <cstdint>
#include <span>
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

/// More values per pixel than the colour: layer NAME has channels NAME.X, NAME.Y and NAME.Z.
using ImageLayers = std::vector<std::pair<std::string, std::vector<std::array<float, 3>>>>;

/// More single values per pixel: one channel each, of that name.
using ImagePlanes = std::vector<std::pair<std::string, std::vector<float>>>;

/// Throws Error if an image cannot be written at `path`: its extension is neither .exr nor .png, its folder is missing
/// or not writable, or something other than a writable file stands there. Changes nothing.
void check_writable(const std::string& path);

/// Writes float32 channels, nothing clamped. The data window is the image's region, the display window the whole image.
/// OpenEXR has no 64-bit integers: an integer beyond 32 bits becomes a string of its digits. The file is replaced as a
/// whole or not at all. Throws Error.
void write_exr(const std::string& path, const XyzImage& image, ColourSpace space, const ImageMetadata& metadata,
               const ImageLayers& layers = {}, const ImagePlanes& planes = {});

/// Writes the image's region in 8-bit sRGB. The file is replaced as a whole or not at all. Throws Error.
void write_png(const std::string& path, const XyzImage& image, const ToneMapping& tone_mapping);

/// The same in the tones of another image, so that images can be compared.
void write_png(const std::string& path, const XyzImage& image, const ToneCurve& curve);

/// Writes width × height pixels in 8-bit sRGB, rows from the top. The file is replaced as a whole or not at all. Throws
/// Error.
void write_png(const std::string& path, int width, int height, std::span<const std::array<std::uint8_t, 3>> pixels);

} // namespace tristim
