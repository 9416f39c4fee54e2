#pragma once

#include "opencl/device_table.h"
#include "opencl/faults.h"
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
    std::size_t largest_group = 1;        ///< work-items in one dimension
    bool fp64 = false;
    bool fma = false; ///< fused multiply-add in hardware
    bool compiler = false;
    bool available = false;
    bool little_endian = false;
    bool full_profile = false; ///< not OpenCL's embedded profile
};

/// Every device of every platform, platforms without devices skipped. Empty if no platform is installed.
std::vector<DeviceInfo> list_devices();

/// An opened device: context and in-order queue with profiling.
struct Device {
    DeviceInfo info;
    DeviceTuning tuning;
    ::cl::Device device;
    ::cl::Context context;
    ::cl::CommandQueue queue;
    std::shared_ptr<FaultPlan> faults; ///< what a test makes fail; none otherwise

    /// To be called before any such call, which fails if a test wants it to.
    void before(DeviceCall call) const {
        if (faults)
            faults->before(call);
    }
};

/// Opens a device by index, by "cpu" or "gpu" (the first), or by part of its name or its platform's name
/// (case-insensitive; the first match). An empty selector takes TRISTIM_DEVICE from the environment, else the first
/// CPU, else the first device. Throws Error if there is no platform, no match or no online compiler, or if the selector
/// is a list.
Device open_device(const std::string& selector);

/// The same for a list of selectors with commas between: "0,2" or "cpu,gpu".
std::vector<Device> open_devices(const std::string& selectors);

/// For a process that is the `turn`th (from 0) of several on its machine: one device of such a list, each process
/// another one in turn. A selector that the devices of one platform match several times, CPUs left out, stands for all
/// of these; a CPU is shared.
Device open_device_in_turn(const std::string& selectors, int turn);

/// The index of the first device that open_device("") would take, -1 if there is none.
int default_device_index(const std::vector<DeviceInfo>& devices);

} // namespace tristim
