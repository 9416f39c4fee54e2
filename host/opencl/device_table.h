#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace tristim {

struct DeviceInfo;

/// What differs between devices without their saying so: which of several ways to run the kernels is fastest, and
/// faults to steer round. None of it changes an image, except that a tree of another width may tell apart otherwise
/// which of two triangles at the same distance is hit.
struct DeviceTuning {
    std::size_t pixel_group = 16;      ///< work-group size of kernels with a work-item per pixel or photon
    std::size_t item_group = 8;        ///< the same where each work-item does much
    std::uint32_t paths_per_item = 64; ///< photon paths that a work-item traces, one after the other: PATHS_PER_ITEM
    std::uint32_t sort_groups =
        2; ///< groups of item_group per compute unit that sort photons, a block of them by each item
    std::size_t scan_group = 1;     ///< work-items that share a row of counts to add up, for the sort
    int bvh_width = 8;              ///< children of a BVH node and triangles of a leaf: BVH_WIDTH, 8, 4 or 2
    std::uint32_t loop_steps = ~0U; ///< after so many a work-item's loops may end without a word

    bool ends_loops() const { return loop_steps != ~0U; }

    bool operator==(const DeviceTuning&) const = default;
};

/// The device's row of the table, groups lowered to what the device allows.
DeviceTuning device_tuning(const DeviceInfo& device);

/// Changes some values: "pixel_group=32,bvh_width=4", named as above. Throws Error for an unknown name or a value that
/// no device can take.
DeviceTuning parse_tuning(const std::string& changes, DeviceTuning tuning);

/// All values in parse_tuning's form.
std::string to_string(const DeviceTuning& tuning);

/// What the device lacks that kernels need, to follow its name: "has no OpenCL C compiler". Empty if nothing.
std::string missing_feature(const DeviceInfo& device);

} // namespace tristim
