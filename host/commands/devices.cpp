#include "commands/devices.h"

#include "base/error.h"
#include "opencl/device.h"

namespace tristim {
namespace {

const char* type_name(cl_device_type type) {
    if ((type & CL_DEVICE_TYPE_CPU) != 0)
        return "CPU";
    if ((type & CL_DEVICE_TYPE_GPU) != 0)
        return "GPU";
    return "accelerator";
}

void run() {
    const std::vector<DeviceInfo> devices = list_devices();
    if (devices.empty())
        fail("no OpenCL device found: install an OpenCL platform (Debian: apt install pocl-opencl-icd)");
    const int chosen = default_device_index(devices);
    constexpr double gib = 1024.0 * 1024.0 * 1024.0;
    for (const DeviceInfo& d : devices) {
        fmt::print("{} {}  {}\n", d.index == chosen ? '*' : ' ', d.index, d.name);
        fmt::print("     platform {}, driver {}, {}\n", d.platform, d.driver, d.opencl_c);
        fmt::print("     {}, {} compute units, vectors of {} floats, {:.1f} GiB ({:.1f} GiB in one buffer), {}\n",
                   type_name(d.type), d.compute_units, d.preferred_float_width,
                   static_cast<double>(d.global_memory) / gib, static_cast<double>(d.largest_allocation) / gib,
                   d.compiler ? "can render" : "cannot render: no OpenCL C compiler");
    }
    fmt::print("* is the device that runs without --device (or set TRISTIM_DEVICE)\n");
}

} // namespace

void add_devices_command(CLI::App& app) {
    app.add_subcommand("devices", "List every OpenCL platform and device")->callback(run);
}

} // namespace tristim
