#pragma once

#include "scene/parameters.h"
#include "scene/scene.h"
#include "scene/spectrum_parameters.h"

namespace tristim {

/// pbrt-v4's "diffuse", "dielectric" and "conductor" with its defaults, smooth ones only. Throws Error for any other
/// kind and for parameters that are unknown or out of range.
Material make_material(const std::string& kind, ParameterList& parameters, const PathResolver& resolve);

} // namespace tristim
