#pragma once

#include "scene/parameters.h"
#include "scene/scene.h"
#include "scene/spectrum_parameters.h"
#include "scene/textures.h"

namespace tristim {

/// pbrt-v4's "diffuse", "dielectric" and "conductor" with its defaults, each perhaps under a thin film (films.h), which
/// makes a "diffuse" one a coated one of index "eta" under the film. Throws Error for any other kind and for parameters
/// that are unknown or out of range.
Material make_material(const std::string& kind, ParameterList& parameters, const PathResolver& resolve,
                       TextureTable& textures);

} // namespace tristim
