#pragma once

#include "opencl/device.h"
#include "opencl/program.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace tristim::selftest {

/// The worst error among the inputs that share a value of the parameter that a case varies.
struct CurvePoint {
    double parameter = 0.0;
    double error = 0.0;
};

/// What a case found. Errors are in the unit that the case says.
struct Measurement {
    double worst = 0.0; ///< infinite as soon as a result is not finite
    std::string where;  ///< the input that gave it, for people: "t = 1e-3 nm, 89.9°, 550 nm"
    std::uint64_t inputs = 0;
    std::vector<CurvePoint> curve; ///< by ascending parameter

    /// Counts an input; where() is called if its error is the worst so far. A result that is not a number counts as an
    /// infinite error.
    void add(double parameter, double error, const std::function<std::string()>& where);
};

/// Where and how a case runs its kernels.
struct Setting {
    const Device& device;
    bool fast_math = false;
    double effort = 1.0; ///< how many inputs, over the usual number; simulators take few
};

/// One numerical core of the kernels, over the whole range of what it may meet, against double precision on the host.
struct Case {
    const char* group;     ///< one word: "film"
    const char* name;      ///< what is varied, with its range: "thickness 0 to 1 mm"
    const char* parameter; ///< of the curve, with its unit: "thickness / nm"
    const char* error;     ///< what the error is: "reflectance, absolute"
    double bound;          ///< of `--math precise`
    double fast_bound;     ///< of `--math fast`; infinite if it promises no more than finite results
    std::function<Measurement(const Setting&)> measure;
};

/// `count` inputs at the usual effort, at least `least`.
std::size_t inputs(const Setting& setting, std::size_t count, std::size_t least = 1);

/// Builds kernels/selftest/FILE for the setting's device and arithmetic.
::cl::Program build(const Setting& setting, const std::string& file, const Macros& macros = {});

/// Gives the program that cases share, for a setting's device and arithmetic; tests give one with a fault.
using Programs = std::function<::cl::Program(const Setting&)>;

/// The same programs, each built when it is first asked for and kept as long as the result.
Programs built_once(Programs build_program);

/// Every case, group by group; each group has a file of its own.
std::vector<Case> all_cases();
std::vector<Case> film_cases();
std::vector<Case> optics_cases();
std::vector<Case> geometry_cases();
std::vector<Case> photon_cases();
std::vector<Case> accumulation_cases();
std::vector<Case> spectrum_cases();
std::vector<Case> sequence_cases();

} // namespace tristim::selftest
