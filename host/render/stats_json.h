#pragma once

#include "render/renderer.h"

#include <nlohmann/json.hpp>

#include <string>

namespace tristim {

/// What `render --stats` writes. `load_seconds` is the time that reading the scene took.
nlohmann::ordered_json stats_json(const Renderer& renderer, const std::string& scene, double load_seconds);

} // namespace tristim
