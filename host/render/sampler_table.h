#pragma once

#include "render/method.h"
#include "spectra/spectrum.h"

#include <vector>

namespace tristim {

/// What samplers that follow the scene's light keep for the plain colour matching functions, so that no wavelength that
/// a light emits weighs more than 1/defensive_share times what it does without the light (Hesterberg 1995's defensive
/// mixture): how much light arrives is a matter of the whole scene, not of the lights' powers alone.
inline constexpr double defensive_share = 1.0 / 32.0;

/// The pdf ∝ matching · emission, in 1/nm, with its defensive share of the pdf ∝ matching. Where no light meets the
/// matching function, that alone.
WavelengthBins illuminant_pdf(const WavelengthBins& matching, const WavelengthBins& emission);

/// The constant table of a sampler as kernels/wavelengths.cl takes it: x̄/k, ȳ/k and z̄/k, then what the sampler's file
/// in kernels/samplers/ asks for. `emission` is FlatScene::emission, what the lights emit up to a factor.
std::vector<float> sampler_table(const Method& method, const WavelengthBins& emission);

} // namespace tristim
