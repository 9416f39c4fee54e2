#pragma once

#include "bvh/bvh.h"
#include "opencl/program.h"
#include "render/flat_scene.h"
#include "render/options.h"

#include <cstddef>
#include <string>
#include <vector>

namespace tristim {

/// The bits of a sort key that each of the two passes of the radix sort looks at: about one bucket per photon.
int radix_bits(int photons_per_pass);

/// What the kernels of a render are built with, all alike: every macro of kernels/config.h that depends on the scene,
/// the options or the device.
Macros kernel_macros(const RenderOptions& options, const Effects& effects, const Bvh& bvh, const DeviceTuning& tuning);

/// Where the sources come from and how they are compiled. `exact` forbids relaxed math whatever the user says.
BuildOptions build_options(const RenderOptions& options, bool exact = false);

/// The kernel files that a render builds, in the order of its steps.
std::vector<std::string> kernel_files(const FlatScene& scene);

/// Bytes that a render keeps on the device for each pixel, and for each photon that it has room for.
struct ItemBytes {
    std::size_t pixel = 0;
    std::size_t photon = 0;
};
ItemBytes item_bytes(const Effects& effects, const WavelengthLayout& layout);

} // namespace tristim
