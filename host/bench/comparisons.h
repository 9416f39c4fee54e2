#pragma once

#include "bench/contestant.h"
#include "bench/plan.h"

#include <string>
#include <vector>

namespace tristim {

/// Notes in each group what `auto` chose, repeat by repeat.
void note_choices(SceneResults& scene);

/// Writes each method's image as it stands, in the reference's tones, and its error map into the folder's images/, and
/// notes them in the results. Throws Error.
void write_images(SceneResults& scene, const std::vector<Contestant>& contestants, const XyzImage& reference,
                  const std::string& folder);

/// Notes in the group "math", if there is one without a note, what fast arithmetic changes, free of noise, from the
/// same passes of both; and the time that it saves.
void compare_math(PlannedScene& planned, DeviceScenes& scenes, const std::vector<Device>& devices, std::uint32_t seed);

} // namespace tristim
