#pragma once

#include "image/image.h"
#include "render/renderer.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace tristim {

/// The error that wavelengths alone leave in renders of a scene without other noise, after some numbers of passes.
struct WavelengthCurve {
    std::vector<std::uint64_t> passes;
    std::vector<double> rmse;           ///< in XYZ (the paper's equation 12), root mean square over repeats
    std::vector<double> standard_error; ///< of rmse, from the scatter of the repeats
};

/// The image that all unbiased methods converge to.
struct ExactImage {
    XyzImage image;
    double error = 0.0; ///< RMSE in XYZ, told from the difference of two halves
};

/// The mean of two renders with spectral:400 of so many passes, with different wavelengths within its bins of 1 nm.
ExactImage exact_image(std::shared_ptr<const DeviceScene> scene, RenderOptions options, const Device& device,
                       std::uint64_t passes);

/// RMSE between two renders of so many passes that have the same wavelengths but different paths.
double geometric_noise(std::shared_ptr<const DeviceScene> scene, const RenderOptions& options, const Device& device,
                       std::uint64_t passes);

/// Powers of two up to `passes`, and that.
std::vector<std::uint64_t> doublings(std::uint64_t passes);

/// The errors after doublings(passes) passes of renders with wavelength seeds options.seed, options.seed + 1, … and the
/// same paths.
WavelengthCurve wavelength_error(std::shared_ptr<const DeviceScene> scene, const RenderOptions& options,
                                 const Device& device, const XyzImage& exact, std::uint64_t passes, int repeats);

} // namespace tristim
