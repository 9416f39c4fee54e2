#include "opencl/device.h"

#include "base/error.h"
#include "opencl/errors.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>

namespace tristim {
namespace {

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

struct Listed {
    DeviceInfo info;
    ::cl::Device device;
};

DeviceInfo query(int index, const std::string& platform, const ::cl::Device& device) {
    DeviceInfo info;
    info.index = index;
    info.platform = platform;
    info.name = device.getInfo<CL_DEVICE_NAME>();
    info.driver = device.getInfo<CL_DRIVER_VERSION>();
    info.opencl_c = device.getInfo<CL_DEVICE_OPENCL_C_VERSION>();
    info.type = device.getInfo<CL_DEVICE_TYPE>();
    info.compute_units = device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
    info.preferred_float_width = device.getInfo<CL_DEVICE_PREFERRED_VECTOR_WIDTH_FLOAT>();
    info.global_memory = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
    info.largest_allocation = device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
    info.fp64 = device.getInfo<CL_DEVICE_EXTENSIONS>().find("cl_khr_fp64") != std::string::npos;
    info.compiler = device.getInfo<CL_DEVICE_COMPILER_AVAILABLE>() == CL_TRUE;
    return info;
}

std::vector<Listed> enumerate() {
    std::vector<Listed> found;
    std::vector<::cl::Platform> platforms;
    try {
        ::cl::Platform::get(&platforms);
    } catch (const ::cl::Error& error) {
        constexpr cl_int platform_not_found = -1001;
        if (error.err() != platform_not_found)
            fail("{}", describe_opencl_error(error));
    }
    for (const auto& platform : platforms) {
        std::vector<::cl::Device> devices;
        try {
            platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
        } catch (const ::cl::Error&) {
            continue; // a platform without devices reports CL_DEVICE_NOT_FOUND
        }
        for (const auto& device : devices)
            found.push_back(
                {query(static_cast<int>(found.size()), platform.getInfo<CL_PLATFORM_NAME>(), device), device});
    }
    return found;
}

bool is_index(const std::string& text) {
    return !text.empty() && text.size() < 9 &&
           std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// The position of the device that the selector names, or -1.
int find_device(const std::vector<DeviceInfo>& devices, const std::string& selector) {
    if (is_index(selector)) {
        const int index = std::stoi(selector);
        return index < static_cast<int>(devices.size()) ? index : -1;
    }
    const auto match = std::find_if(devices.begin(), devices.end(), [&](const DeviceInfo& info) {
        return lower(info.name).find(lower(selector)) != std::string::npos ||
               lower(info.platform).find(lower(selector)) != std::string::npos;
    });
    return match != devices.end() ? match->index : -1;
}

std::vector<DeviceInfo> infos(const std::vector<Listed>& listed) {
    std::vector<DeviceInfo> result;
    for (const Listed& entry : listed)
        result.push_back(entry.info);
    return result;
}

std::string environment_selector() {
    const char* value = std::getenv("TRISTIM_DEVICE");
    return value != nullptr ? value : "";
}

} // namespace

std::vector<DeviceInfo> list_devices() {
    return infos(enumerate());
}

int default_device_index(const std::vector<DeviceInfo>& devices) {
    if (const std::string selector = environment_selector(); !selector.empty())
        return find_device(devices, selector);
    const auto cpu = std::find_if(devices.begin(), devices.end(), [](const DeviceInfo& info) {
        return info.compiler && (info.type & CL_DEVICE_TYPE_CPU) != 0;
    });
    if (cpu != devices.end())
        return cpu->index;
    return devices.empty() ? -1 : 0;
}

Device open_device(const std::string& selector) {
    const std::vector<Listed> listed = enumerate();
    if (listed.empty())
        fail("no OpenCL device found: install an OpenCL platform (Debian: apt install pocl-opencl-icd)");
    const std::vector<DeviceInfo> devices = infos(listed);
    const int index = selector.empty() ? default_device_index(devices) : find_device(devices, selector);
    if (index < 0)
        fail("device '{}' not found among {} OpenCL device(s): see 'tristim devices'",
             selector.empty() ? environment_selector() : selector, devices.size());

    Device device;
    device.info = devices[static_cast<std::size_t>(index)];
    if (!device.info.compiler)
        fail("device '{}' has no OpenCL C compiler, which tristim needs", device.info.name);
    device.device = listed[static_cast<std::size_t>(index)].device;
    try {
        device.context = ::cl::Context(device.device);
        device.queue = ::cl::CommandQueue(device.context, device.device, CL_QUEUE_PROFILING_ENABLE);
    } catch (const ::cl::Error& error) {
        fail("device '{}' cannot be opened: {}", device.info.name, describe_opencl_error(error));
    }
    return device;
}

} // namespace tristim
