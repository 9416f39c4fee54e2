#pragma once

#include "bench/results.h"
#include "opencl/device.h"

namespace tristim {

/// What /proc and uname say of this machine; what they do not say is left empty or 0.
BenchMachine describe_machine();

BenchDevice describe_device(const Device& device);

/// The most memory this process has held so far, bytes.
std::uint64_t peak_process_memory();

} // namespace tristim
