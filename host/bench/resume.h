#pragma once

#include "bench/plan.h"

namespace tristim {

/// Puts what an earlier run measured into the plan. Throws Error, which names `source` and what differs, unless the
/// earlier run had the same plan.
void take_over(BenchPlan& plan, const BenchResults& earlier, const std::string& source);

} // namespace tristim
