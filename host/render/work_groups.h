#pragma once

#include <cstddef>

namespace tristim {

/// Work-group sizes. They are always given: PoCL compiles a kernel anew for each size, and left alone it chooses one
/// that divides the number of work-items, down to 1.
/// Kernels with a work-item per pixel or photon. On PoCL a pass takes 1 % longer with 64, 3 % with 256.
inline constexpr std::size_t pixel_group = 16;
/// Kernels whose work-items do much each; the least that rusticl takes.
inline constexpr std::size_t item_group = 8;

} // namespace tristim
