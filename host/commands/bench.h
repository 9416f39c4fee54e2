#pragma once

#include <CLI/CLI.hpp>

#include <string>

namespace tristim {

/// Registers `tristim bench`: error against time of methods and settings. The results keep the command line.
void add_bench_command(CLI::App& app, std::string command_line);

} // namespace tristim
