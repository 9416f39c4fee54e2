#pragma once

#include <CLI/CLI.hpp>

namespace tristim {

/// Registers `spectra`: lists, prints and draws the named spectra.
void add_spectra_command(CLI::App& app);

} // namespace tristim
