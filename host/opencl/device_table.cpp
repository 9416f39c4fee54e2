#include "opencl/device_table.h"

#include "base/error.h"
#include "base/parse_number.h"
#include "base/split.h"
#include "opencl/device.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <limits>

namespace tristim {
namespace {

struct Row {
    cl_device_type type; ///< CL_DEVICE_TYPE_ALL for any
    const char* name;    ///< part of the device's or its platform's name, in small letters
    DeviceTuning tuning;
};

/// The first row that fits counts. `scripts/tune DEVICE` measures a device's row.
constexpr std::array table{
    // Mesa's software driver (22.3). Each work-item is a lane of its vectors, so that wide nodes gain nothing: through
    // nodes of 4 it traces 1.1 to 1.7 times as many rays a second as through nodes of 8. Groups of less than 8 gave
    // wrong results. A work-item's loops, the traversal's too, end after 65535 steps in all: hence few photon paths.
    Row{CL_DEVICE_TYPE_ALL,
        "llvmpipe",
        {.paths_per_item = 8, .scan_group = 8, .bvh_width = 4, .loop_steps = 1U << 14U}},
    // Measured on PoCL 3.1.
    Row{CL_DEVICE_TYPE_CPU, "", {}},
    // Measured on an NVIDIA H100 (driver 580). Narrow nodes, which Guthe 2014 ("Latency Considerations of Depth-first
    // GPU Ray Tracing") found best, are not so there: a pass takes 0.98 to 1.11 times as long with 4 children as
    // with 8, and photon paths twice as long with 2.
    Row{CL_DEVICE_TYPE_GPU,
        "",
        {.pixel_group = 64, .item_group = 32, .paths_per_item = 2, .sort_groups = 1, .scan_group = 256}},
    // Any other device.
    Row{CL_DEVICE_TYPE_ALL, "", {}},
};
static_assert(table.back().type == CL_DEVICE_TYPE_ALL && *table.back().name == '\0', "some row fits any device");

bool contains(std::string text, const char* part) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text.find(part) != std::string::npos;
}

/// 102 for "OpenCL C 1.2 pocl", 0 for what is no version.
int opencl_c_version(const std::string& text) {
    const std::vector<std::string> words = split(text, ' ');
    const std::vector<std::string> numbers = split(words.size() > 2 ? words[2] : "", '.');
    return 100 * parse_number<int>(numbers[0]).value_or(0) +
           (numbers.size() > 1 ? parse_number<int>(numbers[1]).value_or(0) : 0);
}

/// A value by its name, with the least and the most that it may be.
struct Value {
    const char* name;
    std::uint64_t least, most;
    std::uint64_t (*get)(const DeviceTuning&);
    void (*set)(DeviceTuning&, std::uint64_t);
};

template <auto member>
constexpr Value value(const char* name, std::uint64_t least, std::uint64_t most) {
    return {name, least, most, [](const DeviceTuning& tuning) { return static_cast<std::uint64_t>(tuning.*member); },
            [](DeviceTuning& tuning, std::uint64_t number) {
                using Number = std::remove_reference_t<decltype(tuning.*member)>;
                tuning.*member = static_cast<Number>(number);
            }};
}

constexpr std::array values{
    value<&DeviceTuning::pixel_group>("pixel_group", 1, 4096),
    value<&DeviceTuning::item_group>("item_group", 1, 4096),
    value<&DeviceTuning::paths_per_item>("paths_per_item", 1, 65536),
    value<&DeviceTuning::sort_groups>("sort_groups", 1, 1024),
    value<&DeviceTuning::scan_group>("scan_group", 1, 4096),
    value<&DeviceTuning::bvh_width>("bvh_width", 2, 8),
    value<&DeviceTuning::loop_steps>("loop_steps", 1024, std::numeric_limits<std::uint32_t>::max()),
};

std::string known_values() {
    std::string names;
    for (const Value& value : values)
        names += fmt::format("{}{}", names.empty() ? "" : ", ", value.name);
    return names;
}

void change(DeviceTuning& tuning, const std::string& assignment) {
    const std::size_t equals = std::min(assignment.find('='), assignment.size());
    const std::string name = assignment.substr(0, equals);
    const auto known = std::find_if(values.begin(), values.end(), [&](const Value& v) { return v.name == name; });
    if (known == values.end())
        fail("--tuning: '{}' is none of {}", name, known_values());
    const std::string text = equals < assignment.size() ? assignment.substr(equals + 1) : "";
    const auto number = parse_number<std::uint64_t>(text);
    if (!number || *number < known->least || *number > known->most)
        fail("--tuning: {} must be a number from {} to {}, not '{}'", name, known->least, known->most, text);
    known->set(tuning, *number);
}

} // namespace

DeviceTuning device_tuning(const DeviceInfo& device) {
    const auto row = std::find_if(table.begin(), table.end(), [&](const Row& r) {
        return (device.type & r.type) != 0 && (contains(device.name, r.name) || contains(device.platform, r.name));
    });
    DeviceTuning tuning = (row != table.end() ? *row : table.back()).tuning;
    tuning.pixel_group = std::min(tuning.pixel_group, device.largest_group);
    tuning.item_group = std::min(tuning.item_group, device.largest_group);
    tuning.scan_group = std::min(tuning.scan_group, device.largest_group);
    return tuning;
}

DeviceTuning parse_tuning(const std::string& changes, DeviceTuning tuning) {
    for (const std::string& assignment : split(changes, ','))
        change(tuning, assignment);
    if (!std::has_single_bit(static_cast<unsigned>(tuning.bvh_width)))
        fail("--tuning: bvh_width must be 8, 4 or 2, not {}", tuning.bvh_width);
    return tuning;
}

std::string to_string(const DeviceTuning& tuning) {
    std::string text;
    for (const Value& value : values)
        text += fmt::format("{}{}={}", text.empty() ? "" : ",", value.name, value.get(tuning));
    return text;
}

std::string missing_feature(const DeviceInfo& device) {
    constexpr int least_version = 102;
    if (!device.available)
        return "is not available: it is in use, switched off or broken";
    if (!device.compiler)
        return "has no OpenCL C compiler, which tristim needs";
    if (opencl_c_version(device.opencl_c) < least_version)
        return fmt::format("compiles '{}', but tristim needs OpenCL C 1.2", device.opencl_c);
    if (!device.full_profile)
        return "has only OpenCL's embedded profile, which allows it to leave out 64-bit integers and infinities, but "
               "tristim needs both";
    if (device.little_endian != (std::endian::native == std::endian::little))
        return "orders the bytes of a number otherwise than this machine's processor, which tristim cannot serve";
    return "";
}

} // namespace tristim
