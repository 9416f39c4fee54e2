#pragma once

#include <CLI/CLI.hpp>

namespace tristim {

/// Registers `merge`: sums of checkpoints.
void add_merge_command(CLI::App& app);

} // namespace tristim
