#pragma once

#include "scene/geometry.h"
#include "scene/parameters.h"
#include "scene/spectrum_parameters.h"

#include <string>
#include <vector>

namespace tristim {

/// The triangles of a pbrt-v4 shape ("trianglemesh", "plymesh", "bilinearmesh", "sphere") or of our "objmesh" in object
/// space. Throws Error for any other kind and for malformed or unsupported parameters. Remarks for the user ("dropped
/// 3 degenerate faces") go to `remarks`.
Geometry make_shape(const std::string& kind, ParameterList& parameters, const PathResolver& resolve,
                    std::vector<std::string>& remarks);

} // namespace tristim
