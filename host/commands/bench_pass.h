#pragma once

#include <CLI/CLI.hpp>

namespace tristim {

/// Registers `bench-pass`: the time of a pass by step, beside its rays alone through the traversal kernel.
void add_bench_pass_command(CLI::App& app);

} // namespace tristim
