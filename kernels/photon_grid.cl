// Step 4: photons sorted by cell, in a stable order, so that a visible point sums its photons in the same order whatever
// the number of threads. A radix sort of (bucket, photon) pairs in two passes of RADIX_BITS bits.
#include "grid.h"

// The sum of `value` over the group's work-items before this one (Hillis & Steele 1986, "Data Parallel Algorithms"); *total: over all of
// them. sums: a number for each.
uint sum_before(uint value, local uint* sums, uint* total) {
    const uint i = (uint)get_local_id(0), n = (uint)get_local_size(0);
    sums[i] = value;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint distance = 1; distance < n; distance *= 2) {
        const uint more = i < distance ? 0u : sums[i - distance];
        barrier(CLK_LOCAL_MEM_FENCE);
        sums[i] += more;
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    *total = sums[n - 1];
    const uint before = sums[i] - value;
    barrier(CLK_LOCAL_MEM_FENCE);
    return before;
}

// Turns numbers[0 … rows · columns) into the sums of those before them, in two steps of a work-group per row each.
kernel void scan_rows(uint columns, const global uint* numbers, global uint* row_sums, local uint* sums) {
    const uint row = (uint)get_group_id(0);
    uint sum = 0, total;
    for (uint column = (uint)get_local_id(0); column < columns; column += (uint)get_local_size(0))
        sum += numbers[row * columns + column];
    sum_before(sum, sums, &total);
    if (get_local_id(0) == 0)
        row_sums[row] = total;
}

kernel void scan_columns(uint columns, const global uint* row_sums, global uint* numbers, local uint* sums) {
    const uint row = (uint)get_group_id(0), n = (uint)get_local_size(0);
    const uint each = (columns + n - 1u) / n, first = min((uint)get_local_id(0) * each, columns);
    const uint begin = row * columns + first, end = row * columns + min(first + each, columns);
    uint rows_before = 0, before_row, sum = 0, total;
    for (uint r = (uint)get_local_id(0); r < row; r += n)
        rows_before += row_sums[r];
    sum_before(rows_before, sums, &before_row);
    for (uint i = begin; i < end; ++i)
        sum += numbers[i];
    sum = before_row + sum_before(sum, sums, &total);
    for (uint i = begin; i < end; ++i) {
        const uint number = numbers[i];
        numbers[i] = sum;
        sum += number;
    }
}

// One work-item for each of `items` of photon_pass and for what is left of the rows that are scanned next, to get where its photons
// begin among all. summary[1], 0 at first: the most photons that one item would have stored, if that is more than there is
// room for.
kernel void photon_counts(const global uint* item_counts, uint items, uint capacity, global uint* item_offsets,
                          global uint* summary) {
    const uint item = (uint)get_global_id(0);
    const uint count = item < items ? item_counts[item] : 0u;
    item_offsets[item] = min(count, capacity);
    if (count > capacity)
        atomic_max(summary + 1, count);
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

// One work-item per block of n pairs: how many pairs have each digit; histogram[digit · blocks + block], to be scanned.
kernel void sort_count(const global uint2* pairs, uint n, uint shift, global uint* histogram) {
    const uint block = (uint)get_global_id(0), blocks = (uint)get_global_size(0);
    uint counts[DIGITS];
    for (uint d = 0; d < DIGITS; ++d)
        counts[d] = 0;
    const uint end = block_begin(n, block + 1, blocks);
    for (uint i = block_begin(n, block, blocks); i < end; ++i)
        ++counts[pairs[i].x >> shift & (DIGITS - 1u)];
    for (uint d = 0; d < DIGITS; ++d)
        histogram[d * blocks + block] = counts[d];
}

// One work-item per block, as many as in sort_count.
kernel void sort_scatter(const global uint2* pairs, uint n, uint shift, const global uint* histogram,
                         global uint2* sorted) {
    const uint block = (uint)get_global_id(0), blocks = (uint)get_global_size(0);
    uint positions[DIGITS];
    for (uint d = 0; d < DIGITS; ++d)
        positions[d] = histogram[d * blocks + block];
    const uint end = block_begin(n, block + 1, blocks);
    for (uint i = block_begin(n, block, blocks); i < end; ++i)
        sorted[positions[pairs[i].x >> shift & (DIGITS - 1u)]++] = pairs[i];
}

// At least one work-item per pair of n and one more: bucket_begin[b] is where bucket b begins among the sorted pairs, for b from 0 to
// BUCKET_COUNT. Of the buckets between two pairs it fills `most`, after the first `skip`.
kernel void bucket_ranges(const global uint2* pairs, uint n, uint skip, uint most, global uint* bucket_begin) {
    const uint i = (uint)get_global_id(0);
    if (i > n)
        return;
    const uint first = skip + (i == 0 ? 0u : pairs[i - 1].x + 1u);
    const uint last = i == n ? BUCKET_COUNT : pairs[i].x;
    for (uint b = first; b <= min(last, first + (most - 1u)); ++b)
        bucket_begin[b] = i;
}
