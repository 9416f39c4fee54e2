#pragma once

#include "render/method.h"
#include "spectra/spectrum.h"

#include <vector>

namespace tristim::selftest {

/// Where an unbiased sampler with a cumulative distribution puts its wavelengths, in double precision and from the
/// formulas alone (not for spectral:400).
class WavelengthOracle {
  public:
    /// `emission`: what the sampler is told that the lights emit.
    WavelengthOracle(Method::Kind kind, const WavelengthBins& emission);

    /// Distributions: one for each of X, Y and Z, or one for all.
    std::size_t rows() const { return cdfs_.size() == 3 ? 3 : 1; }

    /// The wavelength in nm at u in [0, 1] of the distribution; u beyond is cut off.
    double lambda(std::size_t row, double u) const;

  private:
    double visible_lambda(double u) const;

    Method::Kind kind_;
    std::vector<std::vector<double>> cdfs_; ///< at the borders of the bins, where they define the distribution
};

/// What kernels/wavelengths.cl is to read from a table of means over the bins: the mean itself, or if it is smooth the
/// line between the means at the centres of bins.
double table_value(const std::vector<float>& bins, bool smooth, double lambda);

} // namespace tristim::selftest
