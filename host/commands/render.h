#pragma once

#include <CLI/CLI.hpp>

namespace tristim {

/// Registers `render`: a scene to images.
void add_render_command(CLI::App& app);

} // namespace tristim
