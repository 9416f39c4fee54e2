#include "base/region.h"

#include "base/error.h"

#include <array>
#include <charconv>

namespace tristim {

bool contains(const Region& outer, const Region& inner) {
    return inner.x >= outer.x && inner.y >= outer.y && inner.x + inner.width <= outer.x + outer.width &&
           inner.y + inner.height <= outer.y + outer.height;
}

Region parse_region(std::string_view text) {
    std::array<int, 4> corners{};
    const char* next = text.data();
    const char* const end = text.data() + text.size();
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const auto [word_end, error] = std::from_chars(next, end, corners[i]);
        const bool separated = i + 1 < corners.size() ? word_end != end && *word_end == ',' : word_end == end;
        if (error != std::errc{} || !separated || corners[i] < 0)
            fail("bad region '{}': expected X0,Y0,X1,Y1, four whole numbers of pixels such as 0,0,64,48", text);
        next = word_end + 1;
    }
    const auto [x0, y0, x1, y1] = corners;
    if (x1 <= x0 || y1 <= y0)
        fail("bad region '{}': it holds no pixel, as it spans X0 <= x < X1 and Y0 <= y < Y1", text);
    return {x0, y0, x1 - x0, y1 - y0};
}

} // namespace tristim
