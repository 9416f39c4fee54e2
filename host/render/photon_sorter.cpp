#include "render/photon_sorter.h"

#include "base/error.h"

#include <algorithm>

namespace tristim {

PhotonSorter::PhotonSorter(const Device& device, const Macros& macros, const BuildOptions& options, int radix_bits)
    : tuning_(device.tuning), radix_bits_(radix_bits),
      blocks_(tuning_.sort_groups * static_cast<std::uint32_t>(tuning_.item_group) * device.info.compute_units),
      summary_(device, "photon summary", 2), histogram_(device, "sort histogram", std::size_t{rows()} * blocks_),
      row_sums_(device, "sort sums", rows()),
      bucket_begin_(device, "bucket ranges", (std::size_t{1} << (2 * radix_bits)) + 1) {
    const ::cl::Program program = build_program(device, "photon_grid.cl", macros, options);
    counts_ = ::cl::Kernel(program, "photon_counts");
    scan_rows_ = ::cl::Kernel(program, "scan_rows");
    scan_columns_ = ::cl::Kernel(program, "scan_columns");
    keys_ = ::cl::Kernel(program, "photon_keys");
    count_ = ::cl::Kernel(program, "sort_count");
    scatter_ = ::cl::Kernel(program, "sort_scatter");
    ranges_ = ::cl::Kernel(program, "bucket_ranges");
}

void PhotonSorter::allocate(const Device& device, std::uint32_t items, std::uint32_t capacity) {
    items_ = items;
    capacity_ = capacity;
    const std::size_t photons = std::size_t{items} * capacity;
    const std::size_t columns = items / rows() + 1;
    item_offsets_ = Buffer<std::uint32_t>(device, "photon offsets", columns * rows());
    pairs_ = Buffer<cl_uint2>(device, "photon keys", photons);
    other_pairs_ = Buffer<cl_uint2>(device, "photon keys, other half", photons);
}

/// Turns numbers, of a multiple of rows() elements, into the sums of those before them.
void PhotonSorter::scan(const Buffer<std::uint32_t>& numbers, const Enqueue& enqueue) {
    const auto columns = static_cast<cl_uint>(numbers.size() / rows());
    const ::cl::LocalSpaceArg sums = ::cl::Local(tuning_.scan_group * sizeof(cl_uint));
    scan_rows_.setArg(0, columns);
    scan_rows_.setArg(1, numbers.cl());
    scan_rows_.setArg(2, row_sums_.cl());
    scan_rows_.setArg(3, sums);
    scan_columns_.setArg(0, columns);
    scan_columns_.setArg(1, row_sums_.cl());
    scan_columns_.setArg(2, numbers.cl());
    scan_columns_.setArg(3, sums);
    for (const ::cl::Kernel& kernel : {scan_rows_, scan_columns_})
        enqueue(kernel, rows() * tuning_.scan_group, tuning_.scan_group);
}

PhotonSorter::Summary PhotonSorter::count(const Device& device, const Buffer<std::uint32_t>& item_counts,
                                          const Enqueue& enqueue) {
    summary_.fill(device, 0U);
    counts_.setArg(0, item_counts.cl());
    counts_.setArg(1, items_);
    counts_.setArg(2, capacity_);
    counts_.setArg(3, item_offsets_.cl());
    counts_.setArg(4, summary_.cl());
    enqueue(counts_, item_offsets_.size(), tuning_.pixel_group);
    scan(item_offsets_, enqueue);
    item_offsets_.copy_element(device, items_, summary_, 0);
    const std::vector<std::uint32_t> summary = summary_.read(device);
    photons_ = summary[0];
    const std::uint64_t steps = photons_ / blocks_ + 2 * rows(); // of sort_count and sort_scatter
    if (steps > tuning_.loop_steps)
        fail("device '{}' may end loops of more than {} steps, too few to sort a pass's {} photons: lower the photons "
             "per pass",
             device.info.name, tuning_.loop_steps, photons_);
    return {summary[0], summary[1]};
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
        for (::cl::Kernel* kernel : {&count_, &scatter_}) {
            kernel->setArg(0, from.cl());
            kernel->setArg(1, photons_);
            kernel->setArg(2, static_cast<cl_uint>(shift));
            kernel->setArg(3, histogram_.cl());
        }
        scatter_.setArg(4, to.cl());
        enqueue(count_, blocks_, tuning_.item_group);
        scan(histogram_, enqueue);
        enqueue(scatter_, blocks_, tuning_.item_group);
    }
    ranges_.setArg(0, pairs_.cl());
    ranges_.setArg(1, photons_);
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
    add(row_sums_);
    add(bucket_begin_);
    add(pairs_);
    add(other_pairs_);
    return sizes;
}

} // namespace tristim
