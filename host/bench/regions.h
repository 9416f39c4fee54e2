#pragma once

#include "bench/results.h"
#include "render/options.h"
#include "scene/scene.h"

#include <string>
#include <vector>

namespace tristim {

/// The whole rendered part ("image"), the regions kept beside the scene, and those given ("glass=60,40,170,150"; one of
/// the same name as a kept one replaces it). Kept ones stand in FILE.regions for FILE.pbrt, a region per line, in
/// pixels of the scene's own resolution, from where they are scaled; # begins a comment; those not within the rendered
/// part are left out. Throws Error for bad names and numbers, for names that come twice, and for given regions outside.
std::vector<NamedRegion> named_regions(const Scene& scene, const RenderOptions& options,
                                       const std::vector<std::string>& given);

} // namespace tristim
