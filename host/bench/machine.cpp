#include "bench/machine.h"

#include <fstream>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <thread>
#include <unistd.h>

namespace tristim {
namespace {

std::string processor_name() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with("model name") && line.find(": ") != std::string::npos)
            return line.substr(line.find(": ") + 2);
    }
    return "";
}

} // namespace

BenchMachine describe_machine() {
    BenchMachine machine;
    machine.processor = processor_name();
    machine.threads = std::thread::hardware_concurrency();
    const long pages = ::sysconf(_SC_PHYS_PAGES);
    const long page_size = ::sysconf(_SC_PAGESIZE);
    if (pages > 0 && page_size > 0)
        machine.memory = static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page_size);
    utsname system{};
    if (::uname(&system) == 0)
        machine.system = std::string(system.sysname) + " " + system.release + " " + system.machine;
    return machine;
}

BenchDevice describe_device(const Device& device) {
    return {device.info.name, device.info.platform, device.info.driver, device.info.opencl_c};
}

std::uint64_t peak_process_memory() {
    rusage usage{};
    return ::getrusage(RUSAGE_SELF, &usage) == 0 ? static_cast<std::uint64_t>(usage.ru_maxrss) * 1024 : 0;
}

} // namespace tristim
