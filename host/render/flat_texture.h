#pragma once

#include "scene/scene.h"
#include "shared_types.h"

#include <vector>

namespace tristim {

/// A texture as the kernels read it; an image's texels are appended to `texels`, those of all textures. Throws Error if
/// there are too many of them for a kernel's index.
SceneTexture flatten_texture(const Texture& texture, const V3d& origin, std::vector<float>& texels);

} // namespace tristim
