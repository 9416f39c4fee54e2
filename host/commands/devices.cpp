#include "commands/devices.h"

#include "base/error.h"
#include "commands/device_check.h"
#include "commands/device_options.h"
#include "commands/status_line.h"
#include "opencl/device.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace tristim {
namespace {

const char* type_name(cl_device_type type) {
    if ((type & CL_DEVICE_TYPE_CPU) != 0)
        return "CPU";
    if ((type & CL_DEVICE_TYPE_GPU) != 0)
        return "GPU";
    return "accelerator";
}

struct DevicesCommand {
    std::string device;
    bool check = false;
    int check_alone = -1;
    double effort = 0.1;
    double time = 90.0;
    bool json = false;
    bool quiet = false;
};

void print_list(const std::vector<DeviceInfo>& devices, int chosen) {
    constexpr double gib = 1024.0 * 1024.0 * 1024.0;
    for (const DeviceInfo& d : devices) {
        const std::string missing = missing_feature(d);
        fmt::print("{} {}  {}\n", d.index == chosen ? '*' : ' ', d.index, d.name);
        fmt::print("     platform {}, driver {}, {}\n", d.platform, d.driver, d.opencl_c);
        fmt::print("     {}, {} compute units, vectors of {} floats, {:.1f} GiB ({:.1f} GiB in one buffer), {}\n",
                   type_name(d.type), d.compute_units, d.preferred_float_width,
                   static_cast<double>(d.global_memory) / gib, static_cast<double>(d.largest_allocation) / gib,
                   missing.empty() ? "can render" : "cannot render: it " + missing);
    }
    fmt::print("* is the device that runs without --device (or set TRISTIM_DEVICE)\n");
}

void print_json(const std::vector<DeviceInfo>& devices, int chosen) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const DeviceInfo& d : devices)
        list.push_back({{"index", d.index},
                        {"default", d.index == chosen},
                        {"name", d.name},
                        {"platform", d.platform},
                        {"driver", d.driver},
                        {"opencl_c", d.opencl_c},
                        {"type", type_name(d.type)},
                        {"compute_units", d.compute_units},
                        {"preferred_float_width", d.preferred_float_width},
                        {"global_memory", d.global_memory},
                        {"largest_allocation", d.largest_allocation},
                        {"missing", missing_feature(d)}});
    fmt::print("{}\n", list.dump(2));
}

/// The variables of this process.
std::vector<std::string> environment() {
    std::vector<std::string> variables;
    for (char** variable = environ; *variable != nullptr; ++variable)
        variables.emplace_back(*variable);
    return variables;
}

/// `original` is the environment from before the first OpenCL call: loaders have been seen to cut OCL_ICD_FILENAMES
/// at its first colon, in place, so that child processes would find one device only.
void check(const DevicesCommand& command, const std::vector<DeviceInfo>& devices,
           const std::vector<std::string>& original) {
    check_effort(command.effort);
    if (!(command.time > 0.0 && command.time <= 1e6))
        fail("--time must be above 0 and at most 1000000 seconds, not {}", command.time);
    const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
    std::vector<DeviceCheck> checks;
    StatusLine status(command.quiet);
    for (const DeviceInfo& device : devices) {
        if (status.due())
            status.show(fmt::format("checking {}", device.name));
        if (const std::string missing = missing_feature(device); !missing.empty()) {
            checks.push_back(unfinished_check(device));
            checks.back().refusal = missing;
            continue;
        }
        checks.push_back(check_in_child(device,
                                        {program, "devices", "--check-alone", std::to_string(device.index), "--effort",
                                         fmt::format("{}", command.effort)},
                                        original, command.time));
    }
    status.finish();
    fmt::print("{}{}", command.json ? check_json(checks) : check_table(checks), command.json ? "\n" : "");
    if (!std::all_of(checks.begin(), checks.end(), [](const DeviceCheck& c) { return c.ok(); }))
        throw CLI::RuntimeError(1);
}

void run(const DevicesCommand& command) {
    if (command.check_alone >= 0) {
        check_device(command.check_alone, command.effort, [](const std::string& line) {
            fmt::print("{}\n", line);
            std::fflush(stdout);
        });
        return;
    }
    const std::vector<std::string> original = environment();
    std::vector<DeviceInfo> devices = list_devices();
    if (devices.empty())
        fail("no OpenCL device found: install an OpenCL platform (Debian: apt install pocl-opencl-icd)");
    const int chosen = default_device_index(devices);
    if (!command.device.empty()) {
        devices.clear();
        for (const Device& device : open_devices(command.device))
            devices.push_back(device.info);
    }
    if (command.check)
        check(command, devices, original);
    else if (command.json)
        print_json(devices, chosen);
    else
        print_list(devices, chosen);
}

} // namespace

void add_devices_command(CLI::App& app) {
    auto command = std::make_shared<DevicesCommand>();
    CLI::App* sub = app.add_subcommand("devices", "List every OpenCL platform and device, or check and time them");
    add_device_option(*sub, command->device);
    sub->add_flag("--check", command->check,
                  "Time a standard render and run the selftest on each: exit status 1 if one fails");
    sub->add_option("--effort", command->effort, "With --check: inputs of the selftest over the usual number")
        ->capture_default_str();
    sub->add_option("--time", command->time, "With --check: seconds for each device, after which the rest is skipped")
        ->capture_default_str();
    sub->add_flag("--json", command->json, "Print JSON");
    sub->add_flag("--quiet", command->quiet, "No progress; the table and errors still show");
    sub->add_option("--check-alone", command->check_alone, "")->group(""); // for the child processes of --check
    sub->callback([command] { run(*command); });
}

} // namespace tristim
