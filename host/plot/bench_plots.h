#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace tristim {

/// Draws the plots of a bench from its results.json, each scene with its "summary" (bench/analysis.h), into
/// FOLDER/plots, which is made if it is missing:
///   SCENE-GROUP-REGION-time.png  RMSE against rendering time, both logarithmic, with the spread over the repeats; the
///                                reference's own error as a dashed line, points from the summary's near_floor_from on
///                                hollow
///   SCENE-GROUP-REGION-bars.png  rendering time until an RMSE is reached, for some of the summary's levels
///   SCENE-GROUP-memory.png       RMSE at equal time against the most device memory used until then, a panel per region
///   SCENE-images.png             the reference and each run's image at equal time above its error map; only if there
///                                is any image. The PNG files are looked for in FOLDER; a missing one is left out.
/// One Python draws all (plot/python.h); then each file is replaced as a whole. Runs have the colours of their
/// positions in the group. Throws Error if a name cannot be part of a file's name, if something is missing in the
/// results, without matplotlib, or if a file cannot be written.
void write_bench_plots(const nlohmann::ordered_json& results, const std::string& folder);

} // namespace tristim
