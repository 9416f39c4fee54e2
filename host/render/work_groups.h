#pragma once

#include <cstddef>

namespace tristim {

/// Work-group sizes. They are always given: PoCL compiles a kernel anew for each size, and left alone it chooses one
/// that divides the number of work-items, down to 1.
inline constexpr std::size_t pixel_group = 64; ///< kernels with a work-item per pixel or photon
inline constexpr std::size_t item_group = 8;   ///< kernels whose work-items do much each; the least that rusticl takes

} // namespace tristim
