#pragma once

#include <CLI/CLI.hpp>

namespace tristim {

/// Registers `bench-reduce`: what it takes ranks to add up their films.
void add_bench_reduce_command(CLI::App& app);

} // namespace tristim
