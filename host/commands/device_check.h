#pragma once

#include "opencl/device.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tristim {

/// What is known of a device after its check, or after as much of it as there was time for.
struct DeviceCheck {
    DeviceInfo device;
    std::string refusal; ///< what the device lacks, if it cannot run kernels at all
    std::string failure; ///< why the check ended early, if it did
    bool out_of_time = false;
    std::optional<double> kernel_seconds; ///< building the standard render's kernels and launching each for once
    std::optional<double> pass_seconds;   ///< median of the standard render's passes
    std::size_t passed = 0;               ///< cases of the selftest
    std::vector<std::string> failed;      ///< cases, "group, case: what went wrong"
    std::vector<std::string> skipped;     ///< cases for which there was no time

    /// Nothing went wrong. A device that is refused is no failure, and neither are cases without time.
    bool ok() const { return failure.empty() && failed.empty(); }
};

/// Renders a built-in scene (a ball of dispersive glass in a room with an area light, 128×128 pixels, 16,384 photon
/// paths, tristimulus:1; the passes' median) and runs the selftest in precise arithmetic with `effort` times its usual
/// inputs. Each step is reported by a line of text for merge_report(), and so is what ends it early.
void check_device(int index, double effort, const std::function<void(const std::string&)>& report);

/// The result before the first line: every case of the selftest skipped.
DeviceCheck unfinished_check(const DeviceInfo& device);

/// Takes one line of check_device() into the result; others, which drivers print, are left alone.
void merge_report(const std::string& line, DeviceCheck& check);

/// Runs `command`, which is to print what check_device() reports, in a process of its own, so that a driver that
/// crashes or hangs ends nothing else. It is ended after `seconds`.
DeviceCheck check_in_child(const DeviceInfo& device, const std::vector<std::string>& command,
                           const std::vector<std::string>& environment, double seconds);

/// One line for each device, the ratio of its passes to the first's, and what failed below.
std::string check_table(const std::vector<DeviceCheck>& checks);

/// The same as JSON.
std::string check_json(const std::vector<DeviceCheck>& checks);

} // namespace tristim
