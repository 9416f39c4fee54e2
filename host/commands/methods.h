#pragma once

#include <CLI/CLI.hpp>

namespace tristim {

/// `tristim methods`: what --method takes.
void add_methods_command(CLI::App& app);

} // namespace tristim
