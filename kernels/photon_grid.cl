// Step 4: photons sorted by cell, in a stable order, so that a visible point sums its photons in the same order whatever
// the number of threads. A radix sort of (bucket, photon) pairs in two passes of RADIX_BITS bits.
#include "grid.h"

// One work-item in all. Turns the number of photons of each of photon_pass's work-items, from `first` to before `end`, into where its
// photons begin among all. summary: [0] photons in all so far, [1] the most that one item would have stored.
kernel void photon_offsets(const global uint* item_counts, uint first, uint end, uint capacity, global uint* item_offsets,
                           global uint* summary) {
    uint total = first == 0u ? 0u : summary[0], most = first == 0u ? 0u : summary[1];
    for (uint i = first; i < end; ++i) {
        item_offsets[i] = total;
        total += min(item_counts[i], capacity);
        most = max(most, item_counts[i]);
    }
    item_offsets[end] = total;
    summary[0] = total;
    summary[1] = most;
}

// One work-item per item of photon_pass: the pairs of its photons.
kernel void photon_keys(const global SceneConstants* constants, const global Photon* photons, uint capacity,
                        const global uint* item_offsets, const global uint* largest_radius, global uint2* pairs) {
    const uint item = (uint)get_global_id(0);
    const float scale = cell_scale(largest_radius);
    const uint count = item_offsets[item + 1] - item_offsets[item];
    for (uint i = 0; i < count; ++i) {
        const uint index = item * capacity + i;
        const global Photon* photon = photons + index;
        const int3 cell = cell_of((float3)(photon->x, photon->y, photon->z), constants, scale);
        const uint bucket = (row_bucket(cell.y, cell.z) + (uint)cell.x) & BUCKET_MASK;
        pairs[item_offsets[item] + i] = (uint2)(bucket, index);
    }
}

#define DIGITS (1u << RADIX_BITS)

// Where block number `block` of `blocks` begins in n pairs.
uint block_begin(uint n, uint block, uint blocks) { return (uint)((ulong)n * block / blocks); }

// One work-item per block of pairs: how many pairs have each digit; histogram[digit · blocks + block].
kernel void sort_count(const global uint2* pairs, const global uint* summary, uint shift, global uint* histogram) {
    const uint block = (uint)get_global_id(0), blocks = (uint)get_global_size(0);
    uint counts[DIGITS];
    for (uint d = 0; d < DIGITS; ++d)
        counts[d] = 0;
    const uint end = block_begin(summary[0], block + 1, blocks);
    for (uint i = block_begin(summary[0], block, blocks); i < end; ++i)
        ++counts[pairs[i].x >> shift & (DIGITS - 1u)];
    for (uint d = 0; d < DIGITS; ++d)
        histogram[d * blocks + block] = counts[d];
}

// Counts become positions in two steps of a work-item per digit each. One work-item for all would take DIGITS · blocks steps, and
// llvmpipe (Mesa 22.3) ends a kernel's loops after 65535 of them without a word.
kernel void sort_totals(uint blocks, const global uint* histogram, global uint* totals) {
    const uint digit = (uint)get_global_id(0);
    uint total = 0;
    for (uint block = 0; block < blocks; ++block)
        total += histogram[digit * blocks + block];
    totals[digit] = total;
}

kernel void sort_scan(uint blocks, const global uint* totals, global uint* histogram) {
    const uint digit = (uint)get_global_id(0);
    uint position = 0;
    for (uint d = 0; d < digit; ++d)
        position += totals[d];
    for (uint block = 0; block < blocks; ++block) {
        const uint count = histogram[digit * blocks + block];
        histogram[digit * blocks + block] = position;
        position += count;
    }
}

// One work-item per block, as many as in sort_count.
kernel void sort_scatter(const global uint2* pairs, const global uint* summary, uint shift, const global uint* histogram,
                         global uint2* sorted) {
    const uint block = (uint)get_global_id(0), blocks = (uint)get_global_size(0);
    uint positions[DIGITS];
    for (uint d = 0; d < DIGITS; ++d)
        positions[d] = histogram[d * blocks + block];
    const uint end = block_begin(summary[0], block + 1, blocks);
    for (uint i = block_begin(summary[0], block, blocks); i < end; ++i)
        sorted[positions[pairs[i].x >> shift & (DIGITS - 1u)]++] = pairs[i];
}

// At least one work-item per pair and one more: bucket_begin[b] is where bucket b begins among the sorted pairs, for b from 0 to
// BUCKET_COUNT. Of the buckets between two pairs it fills `most`, after the first `skip`.
kernel void bucket_ranges(const global uint2* pairs, const global uint* summary, uint skip, uint most,
                          global uint* bucket_begin) {
    const uint i = (uint)get_global_id(0), n = summary[0];
    if (i > n)
        return;
    const uint first = skip + (i == 0 ? 0u : pairs[i - 1].x + 1u);
    const uint last = i == n ? BUCKET_COUNT : pairs[i].x;
    for (uint b = first; b <= min(last, first + (most - 1u)); ++b)
        bucket_begin[b] = i;
}
