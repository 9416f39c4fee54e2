#pragma once

#include "base/error.h"
#include "opencl/device.h"

#include <CLI/CLI.hpp>

#include <string>

namespace tristim {

/// Registers --device, for open_device().
inline void add_device_option(CLI::App& command, std::string& device) {
    command
        .add_option(
            "--device", device,
            "OpenCL device: index, cpu, gpu, or part of its name or platform; render shares passes among several "
            "with commas between, and ranks of mpirun take turns at them [TRISTIM_DEVICE, else first CPU]")
        ->type_name("INDEX|NAME");
}

/// Throws Error unless --effort, the inputs of the selftest over their usual number, makes sense.
inline void check_effort(double effort) {
    if (!(effort > 0.0 && effort <= 1000.0))
        fail("--effort must be above 0 and at most 1000, not {}", effort);
}

/// Registers --tuning, for open_tuned_device().
inline void add_tuning_option(CLI::App& command, std::string& tuning) {
    command.add_option("--tuning", tuning, "Other values than the table of devices has, for scripts/tune")
        ->type_name("NAME=VALUE,…");
}

/// open_device(), with changes as parse_tuning() takes them, or none. Throws Error.
inline Device open_tuned_device(const std::string& selector, const std::string& changes) {
    Device device = open_device(selector);
    if (!changes.empty())
        device.tuning = parse_tuning(changes, device.tuning);
    return device;
}

/// Registers --math, "precise" or "fast"; `math` holds the default.
inline void add_math_option(CLI::App& command, std::string& math) {
    command.add_option("--math", math, "Kernel arithmetic: precise, or fast (relaxed math)")
        ->check(CLI::IsMember({"precise", "fast"}))
        ->capture_default_str();
}

} // namespace tristim
