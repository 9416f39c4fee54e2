#pragma once

#include "scene/parameters.h"
#include "scene/scene.h"
#include "scene/spectrum_parameters.h"
#include "scene/textures.h"

namespace tristim {

/// The thin film of a material, from "filmthickness" (nm, outermost layer first; or a texture for a single layer),
/// "filmeta" and "filmk", which pbrt-v4 does not have. Without any of them there is no layer. Throws Error
/// "file:line: …" unless the lists are of equal length, thicknesses ≥ 0, and indices > 0 (k ≥ 0) over the visible
/// range.
Film film_parameters(ParameterList& parameters, const PathResolver& resolve, TextureTable& textures);

} // namespace tristim
