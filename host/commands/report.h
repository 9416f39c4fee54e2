#pragma once

#include <CLI/CLI.hpp>

namespace tristim {

/// Registers `tristim report`.
void add_report_command(CLI::App& app);

} // namespace tristim
