#pragma once

#include "image/image.h"

#include <string>

namespace tristim {

/// Reads an OpenEXR file (half or float) with channels R, G, B (linear, Rec.709 primaries) or X, Y, Z; other channels
/// are ignored. The region is the data window, in pixels from the display window's corner. Throws Error if the file is
/// missing, damaged, has no such channels or other primaries, or holds pixels that are not finite.
XyzImage read_exr(const std::string& path);

} // namespace tristim
