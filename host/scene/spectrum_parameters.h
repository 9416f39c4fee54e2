#pragma once

#include "scene/parameters.h"
#include "spectra/spectrum.h"

#include <functional>
#include <optional>
#include <string>

namespace tristim {

/// Turns the file name of a .spd spectrum into a path.
using PathResolver = std::function<std::string(const std::string& name, const SourceLocation& where)>;

/// True if a spectrum's name is that of a .spd file.
bool is_spectrum_file(const std::string& name);

/// Throws Error at `where` unless a refractive index (or its imaginary part, if `may_be_zero`), called `name`, covers
/// the visible range and is > 0 there (≥ 0 if `may_be_zero`).
void check_index(const Spectrum& spectrum, const std::string& name, bool may_be_zero, const SourceLocation& where);

/// A reflectance, absent if not given. Throws Error unless it lies in [0,1] over the visible range.
std::optional<Spectrum> reflectance_parameter(ParameterList& parameters, const std::string& name,
                                              const PathResolver& resolve);

/// A refractive index or its imaginary part, absent if not given and checked as by check_index().
std::optional<Spectrum> index_parameter(ParameterList& parameters, const std::string& name, bool may_be_zero,
                                        const PathResolver& resolve);

/// The spectrum of a light normalised as pbrt-v4 does ("spectrum" and "blackbody": to Y = 1, "rgb": the white of the
/// colour space to Y = 1), stdillum-D65 if not given. Throws Error if it is negative or zero over the visible range.
Spectrum emission_parameter(ParameterList& parameters, const std::string& name, const PathResolver& resolve);

} // namespace tristim
