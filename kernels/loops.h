// Devices that end a work-item's loops without a word: llvmpipe (Mesa 22.3) lets the eight work-items of a vector take 65535 steps of
// loops in all, and then leaves every loop after its first step.
#ifndef TRISTIM_LOOPS_H
#define TRISTIM_LOOPS_H

#include "config.h"
#include "shared_types.h"

// At the end of a kernel: counts the work-item (CUT_LOOPS of shared_types.h) if a loop of two steps ends after one. A compiler cannot
// tell that the number of dimensions is 1.
void count_cut_loops(global uint* counts) {
#if LOOPS_END_EARLY
    const uint steps = 1u + get_work_dim();
    uint taken = 0;
    for (uint i = 0; i < steps; ++i)
        ++taken;
    if (taken != steps)
        atomic_inc(counts + 2 * CUT_LOOPS);
#endif
}

#endif
