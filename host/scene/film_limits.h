#pragma once

namespace tristim {

/// The thickest layer that a film may have, in nm: of much thicker ones no lamp's light is coherent.
inline constexpr double max_layer_thickness_nm = 1e6;

} // namespace tristim
