#pragma once

#include "opencl/buffer.h"
#include "opencl/program.h"
#include "shared_types.h"

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace tristim {

/// Sorts photons into the hash grid (kernels/photon_grid.cl): pairs of bucket and photon in ascending, stable order,
/// and where each bucket begins.
class PhotonSorter {
  public:
    PhotonSorter() = default;

    /// Builds the kernels for a device; radix_bits as RADIX_BITS of kernels/config.h.
    PhotonSorter(const Device& device, const Macros& macros, const BuildOptions& options, int radix_bits);

    /// Room for `items` work-items of photon_pass with `capacity` photons each.
    void allocate(const Device& device, std::uint32_t items, std::uint32_t capacity);

    /// Runs a kernel with so many work-items in groups of so many.
    using Enqueue = std::function<void(const ::cl::Kernel&, std::size_t items, std::size_t group)>;

    struct Summary {
        std::uint32_t photons;       ///< in all
        std::uint32_t most_per_item; ///< that one item would have stored, if that is more than the capacity and some
                                     ///< are missing; else 0
    };
    /// After photon_pass: counts its photons (item_counts) and waits for the device.
    Summary count(const Device& device, const Buffer<std::uint32_t>& item_counts, const Enqueue& enqueue);

    /// Sorts the photons that were counted by cells of about twice the largest radius.
    void sort(const Buffer<SceneConstants>& constants, const Buffer<Photon>& photons,
              const Buffer<std::uint32_t>& largest_radius, const Enqueue& enqueue);

    const Buffer<cl_uint2>& pairs() const { return pairs_; }
    const Buffer<std::uint32_t>& bucket_begin() const { return bucket_begin_; }
    /// One of its kernels; all are of one program.
    const ::cl::Kernel& kernel() const { return ranges_; }

    const Buffer<std::uint32_t>& item_offsets() const { return item_offsets_; }
    std::vector<std::pair<std::string, std::uint64_t>> sizes() const;

  private:
    std::uint32_t rows() const { return 1U << static_cast<unsigned>(radix_bits_); }
    void scan(const Buffer<std::uint32_t>& numbers, const Enqueue& enqueue);

    DeviceTuning tuning_;
    int radix_bits_ = 0;
    std::uint32_t blocks_ =
        0; ///< pieces that pairs are sorted in, by a work-item each; the result does not depend on it
    std::uint32_t items_ = 0;
    std::uint32_t capacity_ = 0;
    std::uint32_t photons_ = 0;          ///< as counted
    Buffer<std::uint32_t> item_offsets_; ///< where each item's photons begin among all, and how many there are in all
    Buffer<std::uint32_t> summary_;      ///< as Summary
    Buffer<std::uint32_t> histogram_;
    Buffer<std::uint32_t> row_sums_; ///< of what is scanned
    Buffer<std::uint32_t> bucket_begin_;
    Buffer<cl_uint2> pairs_;
    Buffer<cl_uint2> other_pairs_;
    ::cl::Kernel counts_;
    ::cl::Kernel scan_rows_;
    ::cl::Kernel scan_columns_;
    ::cl::Kernel keys_;
    ::cl::Kernel count_;
    ::cl::Kernel scatter_;
    ::cl::Kernel ranges_;
};

} // namespace tristim
