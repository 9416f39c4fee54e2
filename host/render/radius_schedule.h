#pragma once

#include "shared_types.h"

#include <cstdint>

namespace tristim {

/// The share of new photons kept as the radius shrinks (Hachisuka et al. 2008; Knaus & Zwicker 2011).
inline constexpr double radius_alpha = 2.0 / 3.0;

/// The radius of a pass over the initial radius: r²_{i+1} = r²_i (i+α)/(i+1) with r_1 initial (Knaus & Zwicker 2011,
/// "Progressive Photon Mapping: A Probabilistic Approach", equation 15), in closed form for any pass = i−1 ≥ 0:
/// r²_i / r²_1 = Γ(i+α) / (Γ(1+α) Γ(i+1)).
double radius_scale(std::uint32_t pass, double alpha = radius_alpha);

/// The largest radius that kernels/grid.h's search_radius may ask for in a scene.
float largest_radius_floor(const SceneConstants& constants);

} // namespace tristim
