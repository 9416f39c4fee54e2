#pragma once

#include "selftest/case.h"

#include <functional>
#include <string>
#include <vector>

namespace tristim::selftest {

/// A case that ran, in one arithmetic.
struct Outcome {
    Case tested;
    bool fast_math = false;
    Measurement found;
    std::string failure; ///< why it could not run to its end, if so
    double seconds = 0.0;

    double bound() const { return fast_math ? tested.fast_bound : tested.bound; }
    bool passed() const;
};

/// A bound as tables show it.
std::string bound_text(double bound);

/// Runs a case; what it throws becomes the outcome's failure, so that the others still run.
Outcome run(const Case& tested, const Setting& setting);

/// A table of outcomes of one arithmetic, with what failed and where below.
std::string table(const std::vector<Outcome>& outcomes);

/// The curves as CSV: group, case, math, parameter, error.
std::string curves_csv(const std::vector<Outcome>& outcomes);

} // namespace tristim::selftest
