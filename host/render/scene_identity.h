#pragma once

#include "base/region.h"
#include "render/options.h"
#include "scene/scene.h"

#include <string>

namespace tristim {

/// What the expected image depends on, whatever the method that renders it.
struct SceneIdentity {
    std::string scene;  ///< hash of geometry, materials, textures, lights and spectra, 16 hexadecimal digits
    std::string camera; ///< hash of the camera at this resolution
    int width = 0;      ///< of the whole image
    int height = 0;
    Region region;
    int max_depth = 0;
    bool operator==(const SceneIdentity&) const = default;
};

/// Hashes what the kernels would read: the flattened scene and its spectra in 1 nm bins. File names, comments,
/// formatting, method and random numbers do not matter; materials that no shape uses do. Throws Error as flatten_scene
/// does.
SceneIdentity scene_identity(const Scene& scene, const RenderOptions& options);

} // namespace tristim
