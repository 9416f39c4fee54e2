#pragma once

#include <CLI/CLI.hpp>

namespace tristim {

/// Registers `bench-rays`: our traversal on an OpenCL device beside Embree's on as many threads.
void add_bench_rays_command(CLI::App& app);

} // namespace tristim
