#include "opencl/device.h"

#include "base/error.h"
#include "base/split.h"
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
    info.fma = (device.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>() & CL_FP_FMA) != 0;
    info.largest_group = std::min(device.getInfo<CL_DEVICE_MAX_WORK_GROUP_SIZE>(),
                                  device.getInfo<CL_DEVICE_MAX_WORK_ITEM_SIZES>().front());
    info.compiler = device.getInfo<CL_DEVICE_COMPILER_AVAILABLE>() == CL_TRUE;
    info.available = device.getInfo<CL_DEVICE_AVAILABLE>() == CL_TRUE;
    info.little_endian = device.getInfo<CL_DEVICE_ENDIAN_LITTLE>() == CL_TRUE;
    info.full_profile = device.getInfo<CL_DEVICE_PROFILE>() == "FULL_PROFILE";
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

/// The positions of the devices that the selector names.
std::vector<int> find_devices(const std::vector<DeviceInfo>& devices, const std::string& selector) {
    if (is_index(selector)) {
        const int index = std::stoi(selector);
        return index < static_cast<int>(devices.size()) ? std::vector{index} : std::vector<int>{};
    }
    const std::string name = lower(selector);
    const cl_device_type type = name == "cpu" ? CL_DEVICE_TYPE_CPU : name == "gpu" ? CL_DEVICE_TYPE_GPU : 0;
    std::vector<int> found;
    for (const DeviceInfo& info : devices) {
        const bool named =
            lower(info.name).find(name) != std::string::npos || lower(info.platform).find(name) != std::string::npos;
        if (type != 0 ? (info.type & type) != 0 : named)
            found.push_back(info.index);
    }
    return found;
}

/// The position of the first device that the selector names, or -1.
int find_device(const std::vector<DeviceInfo>& devices, const std::string& selector) {
    const std::vector<int> found = find_devices(devices, selector);
    return found.empty() ? -1 : found.front();
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

/// Opens one of the devices, as the `place`th of a list.
Device open_listed(const std::vector<Listed>& listed, const std::string& selector, int place) {
    const std::vector<DeviceInfo> devices = infos(listed);
    const int index = selector.empty() ? default_device_index(devices) : find_device(devices, selector);
    if (index < 0)
        fail("device '{}' not found among {} OpenCL device(s): see 'tristim devices'", selector, devices.size());

    Device device;
    device.info = devices[static_cast<std::size_t>(index)];
    if (const std::string missing = missing_feature(device.info); !missing.empty())
        fail("device '{}' {}", device.info.name, missing);
    device.tuning = device_tuning(device.info);
    device.device = listed[static_cast<std::size_t>(index)].device;
    device.faults = fault_plan_from_environment(place);
    try {
        device.context = ::cl::Context(device.device);
        device.queue = ::cl::CommandQueue(device.context, device.device, CL_QUEUE_PROFILING_ENABLE);
    } catch (const ::cl::Error& error) {
        fail("device '{}' cannot be opened: {}", device.info.name, describe_opencl_error(error));
    }
    return device;
}

/// The names in a list of selectors, or in the environment's; one empty name for the default.
std::vector<std::string> selectors_in(const std::string& list) {
    const std::string given = list.empty() ? environment_selector() : list;
    std::vector<std::string> selectors = split(given, ',');
    if (selectors.size() > 1 && std::find(selectors.begin(), selectors.end(), "") != selectors.end())
        fail("the list of devices '{}' has an empty place", given);
    return selectors;
}

/// The devices of a list among which several processes take turns, as indices; selectors that name none stay.
std::vector<std::string> turns(const std::vector<DeviceInfo>& devices, const std::string& list) {
    std::vector<std::string> result;
    for (const std::string& selector : selectors_in(list)) {
        const std::vector<int> found = selector.empty() ? std::vector<int>{} : find_devices(devices, selector);
        const auto at = [&](int index) { return devices[static_cast<std::size_t>(index)]; };
        if (found.empty() || (at(found.front()).type & CL_DEVICE_TYPE_CPU) != 0) {
            result.push_back(selector);
            continue;
        }
        for (const int index : found) {
            if ((at(index).type & CL_DEVICE_TYPE_CPU) == 0 && at(index).platform == at(found.front()).platform)
                result.push_back(std::to_string(index));
        }
    }
    return result;
}

std::vector<Listed> enumerate_some() {
    std::vector<Listed> listed = enumerate();
    if (listed.empty())
        fail("no OpenCL device found: install an OpenCL platform (Debian: apt install pocl-opencl-icd)");
    return listed;
}

} // namespace

std::vector<DeviceInfo> list_devices() {
    return infos(enumerate());
}

int default_device_index(const std::vector<DeviceInfo>& devices) {
    if (const std::string selector = selectors_in("").front(); !selector.empty())
        return find_device(devices, selector);
    const auto cpu = std::find_if(devices.begin(), devices.end(), [](const DeviceInfo& info) {
        return info.compiler && (info.type & CL_DEVICE_TYPE_CPU) != 0;
    });
    if (cpu != devices.end())
        return cpu->index;
    return devices.empty() ? -1 : 0;
}

Device open_device(const std::string& selector) {
    std::vector<Device> devices = open_devices(selector);
    if (devices.size() > 1)
        fail("this runs on one device, not on the {} of '{}'", devices.size(),
             selector.empty() ? environment_selector() : selector);
    return devices.front();
}

std::vector<Device> open_devices(const std::string& selectors) {
    const std::vector<Listed> listed = enumerate_some();
    std::vector<Device> devices;
    for (const std::string& selector : selectors_in(selectors))
        devices.push_back(open_listed(listed, selector, static_cast<int>(devices.size())));
    return devices;
}

Device open_device_in_turn(const std::string& selectors, int turn) {
    const std::vector<Listed> listed = enumerate_some();
    const std::vector<std::string> choice = turns(infos(listed), selectors);
    return open_listed(listed, choice[static_cast<std::size_t>(turn) % choice.size()], 0);
}

} // namespace tristim
