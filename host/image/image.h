#pragma once

#include "base/region.h"

#include <array>
#include <vector>

namespace tristim {

/// CIE XYZ of the pixels of a region of an image, in rows from the top; a white of radiance 1 has Y = 1.
struct XyzImage {
    int full_width = 0; ///< of the whole image
    int full_height = 0;
    Region region;
    std::vector<std::array<float, 3>> xyz; ///< region.pixels() of them
};

} // namespace tristim
