#pragma once

#include <CLI/CLI.hpp>

namespace tristim {

/// `tristim selftest`: whether a device's numbers can be trusted.
void add_selftest_command(CLI::App& app);

} // namespace tristim
