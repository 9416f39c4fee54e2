#pragma once

#include "image/image.h"
#include "image/write_image.h"

#include <string>

namespace tristim {

/// Reads an OpenEXR file (half or float) with channels R, G, B (linear, Rec.709 primaries) or X, Y, Z; other channels
/// are ignored. The region is the data window, in pixels from the display window's corner. Throws Error if the file is
/// missing, damaged, has no such channels or other primaries, or holds pixels that are not finite.
XyzImage read_exr(const std::string& path);

/// An EXR file with all that write_exr put into it.
struct LayeredImage {
    XyzImage image;
    ImageLayers layers;     ///< sorted by name
    ImageMetadata metadata; ///< without the prefix "tristim:", in no order
};

/// The same with every group of channels NAME.X, NAME.Y, NAME.Z, whose values must be finite, too.
LayeredImage read_layered_exr(const std::string& path);

} // namespace tristim
