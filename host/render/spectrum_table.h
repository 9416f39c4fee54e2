#pragma once

#include "render/method.h"
#include "spectra/spectrum.h"

#include <vector>

namespace tristim {

/// The spectra of a scene, as rows of the table that kernels/wavelengths.cl evaluates for each pass.
class SpectrumTable {
  public:
    /// What a spectrum is for; decides how it is read between bins, and how RGB rendering integrates it.
    enum class Use {
        Emission,    ///< bin means as they are: lines keep their energy
        Reflectance, ///< linear between bin centres; in RGB clamped to [0,1]
        Index,       ///< refractive index: linear between bin centres
    };

    /// Adds a spectrum and returns its row.
    int add(const Spectrum& spectrum, Use use);

    int rows() const { return static_cast<int>(entries_.size()); }

    /// For all methods but rgb the 400 bin means of each row; for rgb three values of each, which are
    /// integrals over the RGB colour matching functions (the paper's "RGB rendering", section 4): emission relative
    /// to 1/k as in equations 2 to 5, the rest as means under D65, so that a constant spectrum keeps its value.
    std::vector<float> values(const Method& method) const;

    /// For each row 1 if it is linear between bin centres.
    std::vector<int> smooth() const;

  private:
    struct Entry {
        Spectrum spectrum;
        Use use;
    };
    std::vector<Entry> entries_;
};

} // namespace tristim
