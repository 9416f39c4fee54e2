#pragma once

#include <CLI/CLI.hpp>

namespace tristim {

/// Registers `bench-film`: the time that the kernels' film optics take on an OpenCL device.
void add_bench_film_command(CLI::App& app);

} // namespace tristim
