#include "opencl/buffer.h"

#include "base/error.h"
#include "opencl/errors.h"

namespace tristim {

::cl::Buffer allocate_device_memory(const Device& device, const std::string& name, std::size_t bytes) {
    constexpr double mib = 1024.0 * 1024.0;
    const double size = static_cast<double>(bytes) / mib;
    if (bytes > device.info.largest_allocation)
        fail("out of device memory: buffer '{}' needs {:.1f} MiB, but '{}' allows {:.1f} MiB in one buffer; lower "
             "--resolution or --photons, or use a method with fewer wavelengths",
             name, size, device.info.name, static_cast<double>(device.info.largest_allocation) / mib);
    try {
        device.before(DeviceCall::Allocate);
        return ::cl::Buffer(device.context, CL_MEM_READ_WRITE, bytes);
    } catch (const ::cl::Error& error) {
        fail("out of device memory: buffer '{}' of {:.1f} MiB: {}", name, size, describe_opencl_error(error));
    }
}

} // namespace tristim
