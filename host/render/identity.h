#pragma once

#include "render/options.h"
#include "scene/scene.h"

#include <string>
#include <utility>
#include <vector>

namespace tristim {

/// All that a pass depends on but its number and the device, by name and value ("method", "hero:4"), in order. The
/// scene, the camera and the kernels stand there as hashes of their content.
using RenderIdentity = std::vector<std::pair<std::string, std::string>>;

/// Of a render of the scene with these options, whose method must have been chosen. Throws Error as scene_identity
/// does, or if the kernels cannot be read.
RenderIdentity render_identity(const Scene& scene, const RenderOptions& options);

/// The value of a name; "" if there is none.
std::string value_of(const RenderIdentity& identity, const std::string& name);

/// How far a render is not the wanted one, one clause for each setting that differs, joined by semicolons: "it was
/// rendered with method tristimulus:1, not hero:4"; empty if they agree in all.
std::string describe_difference(const RenderIdentity& is, const RenderIdentity& wanted);

} // namespace tristim
