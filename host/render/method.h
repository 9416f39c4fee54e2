#pragma once

#include "opencl/program.h"

#include <string>

namespace tristim {

/// A rendering method: how the wavelengths of a pass are chosen and weighted.
struct Method {
    enum class Kind { Tristimulus, Spectral, RgbBands };
    Kind kind = Kind::Tristimulus;
    int sets = 1; ///< Tristimulus: N, sets of three wavelengths

    int wavelengths() const;  ///< W
    std::string name() const; ///< "tristimulus:1", as the command line takes it
};

/// The most sets that tristimulus:N accepts.
inline constexpr int max_sets = 256;

/// Parses "tristimulus:N", "spectral:400" or "rgb". Throws Error for anything else.
Method parse_method(const std::string& text);

/// How W wavelengths lie in vectors: blocks of `lanes` floats.
struct WavelengthLayout {
    int w = 3;
    int lanes = 4;
    int blocks = 1;
    int padded() const { return lanes * blocks; }
};
WavelengthLayout wavelength_layout(const Method& method);

/// The macros W, LANES, BLOCKS, SAMPLER and SEQUENCE_RANDOM of kernels/config.h.
Macros method_macros(const Method& method, bool random_sequence);

} // namespace tristim
