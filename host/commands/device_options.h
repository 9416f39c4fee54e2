#pragma once

#include <CLI/CLI.hpp>

#include <string>

namespace tristim {

/// Registers --device, for open_device().
inline void add_device_option(CLI::App& command, std::string& device) {
    command.add_option("--device", device, "OpenCL device: index, or part of its name or platform [first CPU]")
        ->type_name("INDEX|NAME");
}

/// Registers --math, "precise" or "fast"; `math` holds the default.
inline void add_math_option(CLI::App& command, std::string& math) {
    command.add_option("--math", math, "Kernel arithmetic: precise, or fast (relaxed math)")
        ->check(CLI::IsMember({"precise", "fast"}))
        ->capture_default_str();
}

} // namespace tristim
