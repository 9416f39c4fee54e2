#pragma once

#include "opencl/device.h"

namespace tristim::test {

/// The device that all tests run on, opened once in a process.
const Device& test_device();

} // namespace tristim::test
