#pragma once

#include <CLI/CLI.hpp>

namespace tristim {

/// Registers `devices`: every OpenCL platform and device, and what they are worth.
void add_devices_command(CLI::App& app);

} // namespace tristim
