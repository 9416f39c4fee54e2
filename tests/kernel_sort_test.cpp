// kernels/photon_grid.cl through PhotonSorter: order, stability and ranges of the sorted photons.

#include "kernel_harness.h"
#include "render/photon_sorter.h"

#include <algorithm>
#include <bit>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <map>

namespace tristim {
namespace {

using namespace kernel_test;

/// What to sort: how many photons each item stored, where they lie, and the largest radius.
struct Case {
    std::string name;
    std::vector<std::uint32_t> item_counts;
    std::uint32_t capacity;
    double extent; ///< photons lie within ±extent
    float largest_radius;
    int radix_bits;
    std::size_t scan_group = 1;
};

using Cell = std::array<int, 3>;

/// The device's own cell of each photon.
std::vector<Cell> cells_of(const Buffer<Photon>& photons, const Buffer<SceneConstants>& constants,
                           const Buffer<std::uint32_t>& largest_radius) {
    const ::cl::Program program = build_test_program(R"(
#include "grid.h"
kernel void cells(const global Photon* photons, const global SceneConstants* constants, const global uint* largest_radius,
                  global int* out) {
    const size_t i = get_global_id(0);
    const float3 position = (float3)(photons[i].x, photons[i].y, photons[i].z);
    vstore3(cell_of(position, constants, cell_scale(largest_radius)), i, out);
}
)");
    const Buffer<Cell> output = make_buffer<Cell>(photons.size());
    run(program, "cells", photons.size(), photons, constants, largest_radius, output);
    return output.read(test_device());
}

void check(const Case& c) {
    SCOPED_TRACE(c.name);
    const auto items = static_cast<std::uint32_t>(c.item_counts.size());
    Device device = test_device();
    device.tuning.scan_group = c.scan_group;
    Random random(50);
    // Unused room holds photons too, which must not appear.
    std::vector<Photon> photons(std::size_t{items} * c.capacity);
    for (Photon& photon : photons) {
        photon.x = static_cast<float>(random(-c.extent, c.extent));
        photon.y = static_cast<float>(random(-c.extent, c.extent));
        photon.z = static_cast<float>(random(-c.extent, c.extent));
    }
    PhotonSorter sorter(device, {{"RADIX_BITS", std::to_string(c.radix_bits)}}, {}, c.radix_bits);
    sorter.allocate(device, items, c.capacity);
    const PhotonSorter::Summary summary = sorter.count(device, upload(c.item_counts), enqueue_in_groups);

    std::vector<std::uint32_t> stored; // the photons' indices, in order
    std::vector<std::uint32_t> offsets{0};
    std::uint32_t most = 0;
    for (std::uint32_t item = 0; item < items; ++item) {
        const std::uint32_t count = std::min(c.item_counts[item], c.capacity);
        most = std::max(most, c.item_counts[item]);
        for (std::uint32_t i = 0; i < count; ++i)
            stored.push_back(item * c.capacity + i);
        offsets.push_back(offsets.back() + count);
    }
    const auto count = static_cast<std::uint32_t>(stored.size());
    ASSERT_EQ(summary.photons, count);
    EXPECT_EQ(summary.most_per_item, most > c.capacity ? most : 0U);
    EXPECT_EQ(sorter.item_offsets().read(device, offsets.size()), offsets);

    const Buffer<SceneConstants> constants = upload(std::vector{SceneConstants{}});
    const Buffer<Photon> photon_buffer = upload(photons);
    const Buffer<std::uint32_t> radius = upload(std::vector{std::bit_cast<std::uint32_t>(c.largest_radius)});
    sorter.sort(constants, photon_buffer, radius, enqueue_in_groups);
    const std::vector<cl_uint2> pairs = sorter.pairs().read(device, count);
    const std::vector<std::uint32_t> begin = sorter.bucket_begin().read(device);

    const std::uint32_t buckets = 1U << (2 * c.radix_bits);
    ASSERT_EQ(begin.size(), buckets + 1U);
    std::vector<std::uint32_t> found;
    std::vector<std::uint32_t> expected_begin(buckets + 1U, 0);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const auto [bucket, photon] = std::array{pairs[i].s[0], pairs[i].s[1]};
        ASSERT_LT(bucket, buckets) << "pair " << i;
        found.push_back(photon);
        ++expected_begin[bucket + 1];
        if (i > 0) {
            ASSERT_LE(pairs[i - 1].s[0], bucket) << "pair " << i << " is out of order";
            if (pairs[i - 1].s[0] == bucket) {
                ASSERT_LT(pairs[i - 1].s[1], photon)
                    << "pair " << i << ": the order within bucket " << bucket << " is not stable";
            }
        }
    }
    for (std::uint32_t b = 0; b < buckets; ++b)
        expected_begin[b + 1] += expected_begin[b];
    EXPECT_EQ(begin, expected_begin);
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, stored) << "photons are missing, doubled, or come from unused room";

    // One bucket per cell, and the next bucket for the next cell along x.
    const std::vector<Cell> cells = cells_of(photon_buffer, constants, radius);
    std::map<Cell, std::uint32_t> bucket_of_cell;
    for (const cl_uint2& pair : pairs) {
        const Cell& cell = cells[pair.s[1]];
        const auto [entry, fresh] = bucket_of_cell.emplace(cell, pair.s[0]);
        ASSERT_EQ(entry->second, pair.s[0])
            << fmt::format("cell {}, {}, {} has two buckets", cell[0], cell[1], cell[2]);
    }
    for (const auto& [cell, bucket] : bucket_of_cell) {
        const auto next = bucket_of_cell.find({cell[0] + 1, cell[1], cell[2]});
        if (next != bucket_of_cell.end()) {
            ASSERT_EQ(next->second, (bucket + 1U) % buckets)
                << fmt::format("cells {} and {} of row {}, {}", cell[0], cell[0] + 1, cell[1], cell[2]);
        }
    }
    // Cells are no smaller than a search's sphere: photons two cells apart are a diameter apart.
    for (std::size_t axis = 0; axis < 3; ++axis) {
        std::map<int, std::array<float, 2>> extents;
        for (std::size_t i = 0; i < photons.size(); ++i) {
            const float x = axis == 0 ? photons[i].x : axis == 1 ? photons[i].y : photons[i].z;
            auto& [low, high] = extents.emplace(cells[i][axis], std::array{x, x}).first->second;
            low = std::min(low, x);
            high = std::max(high, x);
        }
        for (const auto& [cell, extent] : extents) {
            const auto after_next = extents.find(cell + 2);
            if (after_next != extents.end()) {
                ASSERT_GE(after_next->second[0] - extent[1], 2.0F * c.largest_radius)
                    << "cells " << cell << " and " << cell + 2 << " along axis " << axis;
            }
        }
    }
}

TEST(KernelSort, SortsFewPhotons) {
    check({"no photons", {0, 0, 0}, 4, 1.0, 0.1F, 4});
    check({"no photons and no radius", {0}, 1, 1.0, 0.0F, 4});
    check({"one photon", {0, 1}, 4, 1.0, 0.1F, 4});
    check({"seven photons", {3, 0, 4}, 4, 1.0, 0.1F, 4});
    check({"more than there is room for", {9, 2, 7}, 4, 1.0, 0.1F, 4});
    check({"no visible point, so no radius", {5, 5}, 5, 20.0, 0.0F, 4});
}

TEST(KernelSort, SortsManyPhotons) {
    Random random(51);
    std::vector<std::uint32_t> partly;
    for (int i = 0; i < 1563; ++i)
        partly.push_back(random.bits() % 129);
    check({"100,000 in partly filled items", partly, 128, 10.0, 0.05F, 9});
    check({"100,000 that collide in 256 buckets", partly, 128, 10.0, 0.05F, 4});
    check({"all in one cell", std::vector<std::uint32_t>(1000, 50), 64, 0.05, 10.0F, 9});
    check({"full items", std::vector<std::uint32_t>(1000, 64), 64, 3.0, 0.1F, 8});
    check({"large buckets", std::vector<std::uint32_t>(200, 64), 64, 3.0, 0.001F, 11});
}

TEST(KernelSort, AddsUpInGroups) {
    const std::vector<std::uint32_t> counts(100, 20);
    check({"no photons", {0, 0, 0}, 4, 1.0, 0.1F, 4, 8});
    check({"three items among eight", {9, 2, 7}, 4, 1.0, 0.1F, 4, 8});
    check({"groups of seven", counts, 32, 10.0, 0.05F, 6, 7});
    check({"groups of 128", counts, 32, 10.0, 0.05F, 6, 128});
}

} // namespace
} // namespace tristim
