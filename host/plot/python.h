#pragma once

#include <span>
#include <string>
#include <string_view>

namespace tristim {

/// Runs embedded Python files (base/embedded_files.h), joined to one program, and returns what it wrote to standard
/// output. `input` is its standard input. The Python is the program that TRISTIM_PYTHON in the environment names, else
/// `python3`, else Debian's own /usr/bin/python3; the next one is tried where one has no matplotlib, which
/// host/plot/style.py finds out. Throws Error ("cannot `task`: …") if none of them has it (naming Debian's package), or
/// if the program fails (with the last line of what it said).
std::string run_python(std::span<const std::string_view> files, const std::string& input, const std::string& task);

} // namespace tristim
