#pragma once

#include <CLI/CLI.hpp>

namespace tristim {

/// Registers `film`: reflectance, transmittance and colour of a thin-film stack.
void add_film_command(CLI::App& app);

} // namespace tristim
