#pragma once

#include "bench/reference.h"
#include "image/write_image.h"

#include <string>
#include <utility>
#include <vector>

namespace tristim {

/// Reference::settings of a render with these options.
std::vector<std::pair<std::string, std::string>> reference_settings(const RenderOptions& options);

/// How far a reference's scene, camera, resolution, region and depth are not the wanted ones: one clause for each that
/// differs, joined by semicolons; empty if all agree.
std::string describe_difference(const Reference& reference, const SceneIdentity& wanted);

/// Writes channels X, Y, Z, the layers "variance", "half1", "half2", "snapshot1" and "snapshot2", and `metadata`
/// together with what the reference knows itself. The file is replaced as a whole or not at all. Throws Error.
void write_reference(const std::string& path, const Reference& reference, ImageMetadata metadata);

} // namespace tristim
