#pragma once

#include <CLI/CLI.hpp>

namespace tristim {

/// Registers `compare`: the error of an image against a reference.
void add_compare_command(CLI::App& app);

} // namespace tristim
