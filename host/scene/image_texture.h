#pragma once

#include "scene/parameters.h"
#include "scene/scene.h"
#include "scene/spectrum_parameters.h"

#include <string>
#include <vector>

namespace tristim {

/// pbrt-v4's "imagemap" as a "float" texture, but for its mapping: the only channel, the mean of R, G and B, or alpha
/// if there is one that is not 1 everywhere, decoded, scaled and inverted. Throws Error "file:line: …" if the file
/// cannot be read or a parameter is wrong. Remarks for the user go to `remarks`.
Texture image_texture(ParameterList& parameters, const PathResolver& resolve, std::vector<std::string>& remarks);

} // namespace tristim
