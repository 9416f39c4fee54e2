#pragma once

#include "selftest/case.h"

#include <cstdint>
#include <string>
#include <vector>

namespace tristim::selftest {

/// The sequence cases for a program of kernels/selftest/sequence.cl that is the caller's: so that tests can see a case
/// catch a fault.
std::vector<Case> sequence_cases(const Programs& cores);

/// Pairs of numbers in [0, 1), counted in cells over the unit square.
class PairCounts {
  public:
    PairCounts(std::size_t columns, std::size_t rows) : columns_(columns), counts_(columns * rows, 0) {}
    void add(double x, double y);

    /// χ² for the independence of columns and rows over its degrees of freedom: about 1 for independent random pairs,
    /// however many; less for stratified ones, up to a few where their nets leave gaps; in proportion to the number of
    /// pairs for dependent ones. 0 if there is but one column or row; those that expect fewer than five in a cell on
    /// average are left out.
    double dependence() const;

  private:
    std::size_t columns_;
    std::vector<std::uint32_t> counts_;
};

/// Of a dependence over 2^15 passes in 16 by 16 cells: random pairs are within 0.6 of 1, stratified ones were found to
/// reach 2.6, and dependent ones reach thousands.
inline constexpr double dependence_bound = 6.0;

/// Passes `first`, `first` + 1, … of a render.
struct LongRun {
    std::uint32_t seed = 0;
    std::uint32_t first = 0;
    std::uint32_t paths_per_pass = 1;
    std::uint32_t path = 0;  ///< the photon path looked at
    std::uint32_t pixel = 0; ///< the pixel looked at
    std::size_t passes = 0;
};

/// The place of a pass's wavelengths, the eight numbers of a photon path, and the eight of a pixel.
struct PassNumbers {
    float wavelengths;
    std::array<float, 8> photon, eye;
};

/// What the passes draw, by the program of kernels/selftest/sequence.cl.
std::vector<PassNumbers> pass_numbers(const Device& device, const ::cl::Program& program, const LongRun& run);

/// The largest dependence between the wavelengths' places and a number of the photon path, as it is and as what it is
/// within one of paths_per_pass equal parts of [0, 1); `which` names the number.
double photon_dependence(const LongRun& run, const std::vector<PassNumbers>& numbers, std::string& which);

/// The same for the pixel's numbers.
double eye_dependence(const LongRun& run, const std::vector<PassNumbers>& numbers, std::string& which);

} // namespace tristim::selftest
