// Values that are not finite are left out where they arise, and counted.
#ifndef TRISTIM_FINITE_H
#define TRISTIM_FINITE_H

#include "shared_types.h"

// Samples beyond this count as not finite: 2^32 of them still add up to a float.
#define LARGEST_SAMPLE 0x1p95f
// And the same for squares.
#define LARGEST_SQUARED_SAMPLE 0x1p47f

// From the exponent's bits: with -cl-fast-relaxed-math a compiler may take isfinite() for true. The sign is shifted out, so that it does
// not recognise a test of a float either.
bool is_finite(float x) { return (as_uint(x) << 1) < 0xff000000u; }
bool is_finite3(float3 v) { return is_finite(v.x) && is_finite(v.y) && is_finite(v.z); }

// Adds to one of the counts that work-items share (NON_FINITE_… of shared_types.h), which have 64 bits.
void count_non_finite(global uint* counts, int kind, uint more) {
    if (more == 0u)
        return;
    const uint before = atomic_add(counts + 2 * kind, more);
    if (before + more < before)
        atomic_inc(counts + 2 * kind + 1);
}

#endif
