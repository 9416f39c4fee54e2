#pragma once

#include "image/write_image.h"
#include "render/renderer.h"

#include <string>
#include <vector>

namespace tristim {

/// What an image's header says of the render: scene file, method, passes, photons, seed, devices, times and so on.
ImageMetadata image_metadata(const RenderOptions& options, const RenderStatistics& statistics,
                             const std::vector<DeviceInfo>& devices, const std::string& scene,
                             std::uint64_t rejected_samples);

/// The same with the numbers of the passes, unless these are the first ones.
ImageMetadata with_passes(ImageMetadata metadata, const PassRanges& passes);

/// The first for a renderer alone.
ImageMetadata image_metadata(const Renderer& renderer, const std::string& scene, std::uint64_t rejected_samples);

} // namespace tristim
