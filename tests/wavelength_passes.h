#pragma once

// Running kernels/wavelengths.cl: one pass after the other, or the sampler alone for thousands of passes at once.

#include "kernel_harness.h"
#include "render/sampler_table.h"
#include "render/spectrum_table.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace tristim::kernel_test {

/// Everything that the kernel makes of a few spectra in one pass after the other.
class Passes {
  public:
    using Use = SpectrumTable::Use;

    /// `emission` is what the sampler is told that the lights emit.
    Passes(const Method& method, bool random_sequence, const WavelengthBins& emission,
           const std::vector<std::pair<Spectrum, Use>>& spectra);
    /// It is told of the spectra of emission.
    Passes(const Method& method, bool random_sequence, const std::vector<std::pair<Spectrum, Use>>& spectra);

    /// The table of a pass, as kernels/spectrum.h lays it out.
    const std::vector<float>& operator()(std::uint32_t pass);

    static constexpr std::uint32_t seed = 77;
    int w() const { return layout_.w; }
    int padded() const { return layout_.padded(); }
    double lambda(int slot) const { return at(0, slot); }
    double weight(std::size_t channel, int slot) const { return at(1 + static_cast<int>(channel), slot); }
    double spectrum(int row, int slot) const { return at(4 + row, slot); }

  private:
    double at(int row, int slot) const { return current_[static_cast<std::size_t>(row * layout_.padded() + slot)]; }

    WavelengthLayout layout_;
    ::cl::Program program_;
    ::cl::Kernel kernel_;
    Buffer<float> sampler_, values_, output_;
    Buffer<std::int32_t> smooth_;
    int rows_ = 0;
    std::vector<float> current_;
};

/// A reflectance with structure, piecewise linear, no steeper than bumpy_slope per nm.
Spectrum bumpy();
inline constexpr double bumpy_slope = 0.4 / 23.0;

/// A wavelength that a sampler drew, its weights, and what a light and a reflectance are there.
struct WavelengthSample {
    float lambda, x, y, z, light, reflectance;

    double weight(std::size_t channel) const { return channel == 0 ? x : channel == 1 ? y : z; }
};

/// What the sampler of a pass works with.
struct SamplerInput {
    Method method;
    bool random_sequence = false;
    WavelengthBins emission{}; ///< what the sampler is told that the lights emit
};

/// The samples of passes 0, 1, …, W of each, as the functions that kernels/wavelengths.cl calls give them; not for rgb,
/// whose spectra are integrated.
std::vector<WavelengthSample> draw_samples(const SamplerInput& input, std::uint32_t seed, std::size_t passes,
                                           const Spectrum& light, const Spectrum& reflectance);

/// The positions in [0, 1) from which the parts of a pass, as many as `parts`, draw their wavelengths: each its own, or
/// rotations of one.
std::vector<float> draw_positions(bool random_sequence, bool rotated, std::uint32_t seed, std::uint32_t pass,
                                  std::uint32_t parts);

} // namespace tristim::kernel_test
