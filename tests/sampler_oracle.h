#pragma once

// What every unbiased sampler of kernels/samplers/ promises, in double precision and from the formulas alone.

#include "kernel_harness.h"
#include "render/sampler_table.h"
#include "spectra/colour.h"

#include <cstdint>
#include <string>
#include <vector>

namespace tristim::kernel_test {

/// How a sampler distributes its wavelengths. It draws from one pdf, or in sets of three from a pdf ("row") for each of
/// X, Y and Z. Each row of a pass has parts() wavelengths, part j of which goes with position j of the pass.
class SamplerOracle {
  public:
    /// `emission`: what the sampler is told that the lights emit. Of an unbiased method.
    SamplerOracle(const Method& method, const WavelengthBins& emission);

    std::size_t rows() const { return rows_.empty() ? 1 : rows_.size(); }
    int parts() const { return method_.wavelengths() / static_cast<int>(rows()); }
    int part(int slot) const { return slot / static_cast<int>(rows()); }
    std::size_t row(int slot) const { return static_cast<std::size_t>(slot) % rows(); }
    /// Whether all positions of a pass follow from one, whatever the sequence.
    bool rotated() const;

    double pdf(std::size_t row, double lambda) const; ///< in 1/nm
    double cdf(std::size_t row, double lambda) const;
    /// The weights of a slot at a wavelength: (x̄, ȳ, z̄)/(k n p), of sets of three one of them alone.
    Xyz weight(int slot, double lambda) const;

    /// How far cdf(λ) may be off the position that a kernel in float drew λ from.
    double cdf_error(std::size_t row, double lambda) const;
    /// The relative error of a weight that a kernel in float found.
    double weight_error(std::size_t row, double lambda) const;

    /// A channel's integrand over positions, L(λ) f(λ)/(k p(λ)) for L the light times a reflectance, which is linear
    /// between the means of its bins: the integral, the integrand's total variation, and what of the integral the
    /// rounded CDF may lose or add.
    struct Integral {
        double value = 0.0, variation = 0.0, rounding = 0.0;
    };
    Integral integral(std::size_t channel, const WavelengthBins& light, const WavelengthBins& reflectance) const;

  private:
    enum class Form { Bins, Uniform, Visible };

    Method method_;
    Form form_ = Form::Bins;
    std::vector<WavelengthBins> rows_; ///< the pdf's bins, if it is given by bins
};

/// Whether the sampler is told of the light that the scene emits.
bool heeds_light(Method::Kind kind);

/// A sampler to test, and a name for it.
struct SamplerCase {
    std::string name;
    Method method;
    WavelengthBins emission{};
};

/// Every unbiased kind of method with these counts (as far as it has them), and with every light of `emissions` if the
/// sampler heeds the light.
std::vector<SamplerCase> sampler_cases(const std::vector<int>& counts, const std::vector<std::string>& emissions);

/// The bin of 1 nm in which a wavelength lies.
std::size_t wavelength_bin(double lambda);

} // namespace tristim::kernel_test
