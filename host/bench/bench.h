#pragma once

#include "bench/plan.h"

#include <functional>
#include <string>

namespace tristim {

/// Where a bench stands. Work is counted in seconds of rendering.
struct BenchProgress {
    double done = 0.0;
    double total = 0.0;
    std::string what; ///< "dispersion, repeat 2 of 3"
};
/// False ends the bench.
using BenchCallback = std::function<bool(const BenchProgress&)>;

/// Measures everything and writes results.json, images/ and references into the folder, which is made if it is missing;
/// results.json also now and then on the way. If `callback` ends it, the state of unfinished renders is kept in state/.
/// Returns whether all was measured. With `resume` goes on from what the folder holds. Throws Error if references do
/// not fit, seeds coincide, files cannot be written, or the folder holds a bench: without `resume` any, with it one of
/// another plan.
bool run_bench(BenchPlan& plan, bool resume, const BenchCallback& callback);

} // namespace tristim
