#pragma once

#include "bench/results.h"
#include "bench/variants.h"
#include "opencl/device.h"
#include "scene/scene.h"

#include <string>
#include <vector>

namespace tristim {

/// A scene to measure. `results` names it, its regions, runs and groups; `options` are those of results.runs.
struct PlannedScene {
    Scene scene;
    SceneResults results;
    std::vector<RenderOptions> options;
    RenderOptions reference_options; ///< of the reference that the bench renders itself
    std::string given_reference;     ///< file; empty: the bench renders its own
};

struct BenchPlan {
    BenchResults results; ///< all but the scenes
    std::vector<Device> devices;
    std::vector<PlannedScene> scenes;
    std::string folder;
    double reference_seconds = 0.0;
};

/// The file of a scene's reference: as given, or relative to the folder if the bench renders it.
std::string reference_name(const PlannedScene& planned);

/// A scene with its variants on every device as runs and groups; equal variants of several groups are one run. Scene
/// names come from file names: that of the folder if the file is called scene.pbrt, else folder and file: "dispersion",
/// "interference-areas-a".
PlannedScene plan_scene(Scene scene, const std::string& file, const std::vector<VariantGroup>& groups,
                        const std::vector<Device>& devices, std::vector<NamedRegion> regions);

/// Makes the names of scenes differ, by numbers behind them.
void make_names_unique(std::vector<PlannedScene>& scenes);

} // namespace tristim
