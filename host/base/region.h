#pragma once

#include <string_view>

namespace tristim {

/// A part of an image, in pixels of the whole image: [x, x+width) × [y, y+height), y downwards from the top.
struct Region {
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;
    int pixels() const { return width * height; }
    bool operator==(const Region&) const = default;
};

/// Whether all of `inner` lies within `outer`.
bool contains(const Region& outer, const Region& inner);

/// "X0,Y0,X1,Y1", the region [X0, X1) × [Y0, Y1). Throws Error unless these are four whole numbers, none of them
/// negative, that span at least one pixel.
Region parse_region(std::string_view text);

} // namespace tristim
