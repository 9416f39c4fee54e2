#pragma once

#include <CLI/CLI.hpp>

namespace tristim {

/// Registers `bench-wavelengths`: the error that methods make by their wavelengths alone.
void add_bench_wavelengths_command(CLI::App& app);

} // namespace tristim
