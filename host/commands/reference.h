#pragma once

#include <CLI/CLI.hpp>

namespace tristim {

/// Registers `reference`: a long render with its error, for others to be measured against.
void add_reference_command(CLI::App& app);

} // namespace tristim
