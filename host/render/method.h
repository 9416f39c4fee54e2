#pragma once

#include "opencl/program.h"

#include <span>
#include <string>

namespace tristim {

/// A rendering method: how the wavelengths of a pass are chosen and weighted.
struct Method {
    enum class Kind {
        Tristimulus,
        Spectral,
        RgbBands,
        Gauss,
        Uniform,
        Cluster,
        Hero,
        Visible,
        Mixture,
        Illuminant,
        IlluminantMixture
    };
    Kind kind = Kind::Tristimulus;
    int count = 1; ///< what follows the colon: sets of three, or wavelengths

    int wavelengths() const;  ///< W
    bool unbiased() const;    ///< whether passes average to the exact XYZ of every spectrum
    std::string name() const; ///< "tristimulus:1", as the command line takes it
};

/// What there is to say about a kind of method; its formula stands in kernels/samplers/.
struct MethodKind {
    Method::Kind kind;
    const char* name;
    const char* count_name; ///< "N", "C", a fixed number, or null if nothing follows the name
    int least, most;        ///< of the count
    int wavelengths;        ///< for each unit of the count
    bool unbiased;
    const char* sampler; ///< value of the macro SAMPLER
    const char* summary; ///< one line of help
    const char* source;
};
std::span<const MethodKind> method_kinds();

/// "tristimulus:N", as help and errors show it.
std::string pattern(const MethodKind& kind);

/// Parses "tristimulus:4", "spectral:400", "rgb" and so on. Throws Error, with what was expected, for anything else.
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
