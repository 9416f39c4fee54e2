#pragma once

#include <CLI/CLI.hpp>

namespace tristim {

/// `tristim effects SCENE`: which effects the scene calls for and why, and what a render of it builds and keeps.
void add_effects_command(CLI::App& app);

} // namespace tristim
