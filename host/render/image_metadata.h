#pragma once

#include "image/write_image.h"
#include "render/renderer.h"

#include <string>

namespace tristim {

/// What an image's header says of the render: scene file, method, passes, photons, seed, device, times and so on.
ImageMetadata image_metadata(const Renderer& renderer, const std::string& scene, std::uint64_t rejected_samples);

} // namespace tristim
