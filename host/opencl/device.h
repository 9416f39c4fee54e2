#pragma once

#include "opencl/opencl.h"

#include <cstdint>
#include <string>
#include <vector>

namespace tristim {

/// What an OpenCL device says of itself.
struct DeviceInfo {
    int index = 0; ///< position among all devices of all platforms; `--device INDEX`
    std::string platform;
    std::string name;
    std::string driver;
    std::string opencl_c; ///< "OpenCL C 1.2 pocl"
    cl_device_type type = 0;
    unsigned compute_units = 0;
    unsigned preferred_float_width = 0;
    std::uint64_t global_memory = 0;      ///< bytes
    std::uint64_t largest_allocation = 0; ///< bytes
    bool fp64 = false;
    bool compiler = false;
};

/// Every device of every platform, platforms without devices skipped. Empty if no platform is installed.
std::vector<DeviceInfo> list_devices();

/// An opened device: context and in-order queue with profiling.
struct Device {
    DeviceInfo info;
    ::cl::Device device;
    ::cl::Context context;
    ::cl::CommandQueue queue;
};

/// Opens a device by index or by part of its name or its platform's name (case-insensitive; the first match).
/// An empty selector takes TRISTIM_DEVICE from the environment, else the first CPU, else the first device.
/// Throws Error if there is no platform, no match or no online compiler.
Device open_device(const std::string& selector);

/// The index that open_device("") would take, -1 if there is none.
int default_device_index(const std::vector<DeviceInfo>& devices);

} // namespace tristim
