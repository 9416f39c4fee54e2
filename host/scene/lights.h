#pragma once

#include "scene/parameters.h"
#include "scene/scene.h"
#include "scene/spectrum_parameters.h"

#include <optional>

namespace tristim {

/// pbrt-v4's "point", "spot", "distant" and constant "infinite" lights under the current transformation, with its
/// defaults and normalisation. Throws Error for any other kind and for parameters that are unknown or out of range.
Light make_light(const std::string& kind, ParameterList& parameters, const M44d& ctm, const PathResolver& resolve);

/// Throws Error "file:line: …" unless scale > 0, position and direction can be held in single precision.
void check_light(const Light& light, const SourceLocation& where);

/// An AreaLightSource "diffuse" that waits for its shape.
struct AreaLight {
    Light light;
    std::optional<double> power; ///< "power": luminous, of each triangle or bilinear patch as in pbrt-v4
};

AreaLight make_area_light(const std::string& kind, ParameterList& parameters, const PathResolver& resolve);

/// The light of a surface of a given area > 0: pbrt-v4 divides "power" by π · area, twice that if two-sided.
Light light_of_area(const AreaLight& area_light, double area);

} // namespace tristim
