#include "render/photon_sorter.h"

#include "base/error.h"

#include <algorithm>

namespace tristim {

PhotonSorter::PhotonSorter(const Device& device, const Macros& macros, const BuildOptions& options, int radix_bits)
    : tuning_(device.tuning), radix_bits_(radix_bits),
      blocks_(tuning_.sort_groups * static_cast<std::uint32_t>(tuning_.item_group) * device.info.compute_units),
      summary_(device, "photon summary", 2),
      histogram_(device, "sort histogram", (std::size_t{1} << radix_bits) * blocks_),
      totals_(device, "sort totals", std::size_t{1} << radix_bits),
      bucket_begin_(device, "bucket ranges", (std::size_t{1} << (2 * radix_bits)) + 1) {
    const ::cl::Program program = build_program(device, "photon_grid.cl", macros, options);
    offsets_ = ::cl::Kernel(program, "photon_offsets");
    keys_ = ::cl::Kernel(program, "photon_keys");
    count_ = ::cl::Kernel(program, "sort_count");
    digit_totals_ = ::cl::Kernel(program, "sort_totals");
    scan_ = ::cl::Kernel(program, "sort_scan");
    scatter_ = ::cl::Kernel(program, "sort_scatter");
    ranges_ = ::cl::Kernel(program, "bucket_ranges");
}

void PhotonSorter::allocate(const Device& device, std::uint32_t items, std::uint32_t capacity) {
    items_ = items;
    capacity_ = capacity;
    const std::size_t photons = std::size_t{items} * capacity;
    item_offsets_ = Buffer<std::uint32_t>(device, "photon offsets", items + 1);
    pairs_ = Buffer<cl_uint2>(device, "photon keys", photons);
    other_pairs_ = Buffer<cl_uint2>(device, "photon keys, other half", photons);
}

void PhotonSorter::count(const Buffer<std::uint32_t>& item_counts, const Enqueue& enqueue) {
    offsets_.setArg(0, item_counts.cl());
    offsets_.setArg(3, capacity_);
    offsets_.setArg(4, item_offsets_.cl());
    offsets_.setArg(5, summary_.cl());
    const std::uint32_t most = std::min(items_, tuning_.loop_steps);
    for (std::uint32_t first = 0; first < items_; first += most) {
        offsets_.setArg(1, first);
        offsets_.setArg(2, std::min(items_ - first, most) + first);
        enqueue(offsets_, 1, 1);
    }
}

PhotonSorter::Summary PhotonSorter::summary(const Device& device) const {
    const std::vector<std::uint32_t> values = summary_.read(device);
    const std::uint64_t steps = values[0] / blocks_ + 2 * totals_.size(); // of sort_count and sort_scatter
    if (steps > tuning_.loop_steps)
        fail("device '{}' may end loops of more than {} steps, too few to sort a pass's {} photons: lower the photons "
             "per pass",
             device.info.name, tuning_.loop_steps, values[0]);
    return {values[0], values[1]};
}

void PhotonSorter::sort(const Buffer<SceneConstants>& constants, const Buffer<Photon>& photons,
                        const Buffer<std::uint32_t>& largest_radius, const Enqueue& enqueue) {
    keys_.setArg(0, constants.cl());
    keys_.setArg(1, photons.cl());
    keys_.setArg(2, capacity_);
    keys_.setArg(3, item_offsets_.cl());
    keys_.setArg(4, largest_radius.cl());
    keys_.setArg(5, pairs_.cl());
    enqueue(keys_, items_, tuning_.item_group);
    for (const int shift : {0, radix_bits_}) {
        const Buffer<cl_uint2>& from = shift == 0 ? pairs_ : other_pairs_;
        const Buffer<cl_uint2>& to = shift == 0 ? other_pairs_ : pairs_;
        count_.setArg(0, from.cl());
        count_.setArg(1, summary_.cl());
        count_.setArg(2, static_cast<cl_uint>(shift));
        count_.setArg(3, histogram_.cl());
        enqueue(count_, blocks_, tuning_.item_group);
        digit_totals_.setArg(0, blocks_);
        digit_totals_.setArg(1, histogram_.cl());
        digit_totals_.setArg(2, totals_.cl());
        enqueue(digit_totals_, totals_.size(), tuning_.item_group);
        scan_.setArg(0, blocks_);
        scan_.setArg(1, totals_.cl());
        scan_.setArg(2, histogram_.cl());
        enqueue(scan_, totals_.size(), tuning_.item_group);
        scatter_.setArg(0, from.cl());
        scatter_.setArg(1, summary_.cl());
        scatter_.setArg(2, static_cast<cl_uint>(shift));
        scatter_.setArg(3, histogram_.cl());
        scatter_.setArg(4, to.cl());
        enqueue(scatter_, blocks_, tuning_.item_group);
    }
    ranges_.setArg(0, pairs_.cl());
    ranges_.setArg(1, summary_.cl());
    ranges_.setArg(4, bucket_begin_.cl());
    // The room for photons rather than their number, which changes with each pass: PoCL would compile the kernel anew.
    const std::size_t range_items = pairs_.size() + 1;
    const std::size_t group = tuning_.pixel_group;
    const auto buckets = static_cast<std::uint32_t>(bucket_begin_.size());
    const std::uint32_t most = std::min(buckets, tuning_.loop_steps);
    for (std::uint32_t skip = 0; skip < buckets; skip += most) {
        ranges_.setArg(2, skip);
        ranges_.setArg(3, most);
        enqueue(ranges_, (range_items + group - 1) / group * group, group);
    }
}

std::vector<std::pair<std::string, std::uint64_t>> PhotonSorter::sizes() const {
    std::vector<std::pair<std::string, std::uint64_t>> sizes;
    const auto add = [&sizes](const auto& buffer) { sizes.emplace_back(buffer.name(), buffer.bytes()); };
    add(item_offsets_);
    add(histogram_);
    add(totals_);
    add(bucket_begin_);
    add(pairs_);
    add(other_pairs_);
    return sizes;
}

} // namespace tristim
