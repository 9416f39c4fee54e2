#pragma once

#include "bench/contestant.h"

#include <functional>
#include <vector>

namespace tristim {

/// Called between slices with the seconds of rendering of all contestants together; false ends the race.
using RaceProgress = std::function<bool(double seconds)>;

/// Renders until every contestant has finished or `progress` says no. The one that has rendered for the shortest time
/// always goes next, for a slice of `slice` seconds, so that drift of the machine hits all alike.
void run_race(std::vector<Contestant>& contestants, const XyzImage& reference, const std::vector<NamedRegion>& regions,
              double slice, const RaceProgress& progress);

} // namespace tristim
