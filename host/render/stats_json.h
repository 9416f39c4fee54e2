#pragma once

#include "render/error_estimate.h"
#include "render/team.h"

#include <nlohmann/json.hpp>

#include <string>

namespace tristim {

/// What `render --stats` writes. `load_seconds` is the time that reading the scene took.
nlohmann::ordered_json stats_json(const RenderOptions& options, const RenderOutcome& outcome, const std::string& scene,
                                  double load_seconds, const ErrorEstimate& estimate);

} // namespace tristim
