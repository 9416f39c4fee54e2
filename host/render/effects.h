#pragma once

#include "opencl/program.h"
#include "scene/scene.h"

namespace tristim {

/// What a scene calls for. Kernels are built with these and hold nothing else.
struct Effects {
    bool dielectric = false;
    bool dispersion = false; ///< a dielectric whose index depends on the wavelength
    bool conductor = false;
    bool shading_normals = false;
    bool thin_lens = false;
    bool point_light = false;
    bool spot_light = false;
    bool distant_light = false;
    bool infinite_light = false;
    bool area_light = false;
};

/// Only materials and lights in use count.
Effects derive_effects(const Scene& scene);

/// The HAS_… macros of kernels/config.h.
Macros effect_macros(const Effects& effects);

} // namespace tristim
