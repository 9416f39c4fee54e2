#include "render/method.h"

#include "base/error.h"
#include "spectra/spectrum.h"

#include <charconv>

namespace tristim {

int Method::wavelengths() const {
    switch (kind) {
    case Kind::Tristimulus:
        return 3 * sets;
    case Kind::Spectral:
        return lambda_bins;
    case Kind::RgbBands:
        break;
    }
    return 3;
}

std::string Method::name() const {
    switch (kind) {
    case Kind::Tristimulus:
        return fmt::format("tristimulus:{}", sets);
    case Kind::Spectral:
        return fmt::format("spectral:{}", lambda_bins);
    case Kind::RgbBands:
        break;
    }
    return "rgb";
}

Method parse_method(const std::string& text) {
    if (text == "rgb")
        return {Method::Kind::RgbBands, 1};
    if (text == "spectral:400")
        return {Method::Kind::Spectral, 1};
    const std::string prefix = "tristimulus:";
    if (text.rfind(prefix, 0) == 0) {
        int sets = 0;
        const char* end = text.data() + text.size();
        const auto [rest, error] = std::from_chars(text.data() + prefix.size(), end, sets);
        if (error == std::errc() && rest == end && sets >= 1 && sets <= max_sets)
            return {Method::Kind::Tristimulus, sets};
    }
    fail("unknown method '{}': expected tristimulus:N with N from 1 to {}, spectral:400 or rgb", text, max_sets);
}

WavelengthLayout wavelength_layout(const Method& method) {
    WavelengthLayout layout;
    layout.w = method.wavelengths();
    layout.lanes = layout.w <= 4 ? 4 : layout.w <= 8 ? 8 : 16;
    layout.blocks = (layout.w + layout.lanes - 1) / layout.lanes;
    return layout;
}

Macros method_macros(const Method& method, bool random_sequence) {
    const WavelengthLayout layout = wavelength_layout(method);
    const char* sampler = method.kind == Method::Kind::Tristimulus ? "SAMPLER_TRISTIMULUS"
                          : method.kind == Method::Kind::Spectral  ? "SAMPLER_SPECTRAL"
                                                                   : "SAMPLER_RGB";
    return {{"W", std::to_string(layout.w)},
            {"LANES", std::to_string(layout.lanes)},
            {"BLOCKS", std::to_string(layout.blocks)},
            {"SAMPLER", sampler},
            {"SEQUENCE_RANDOM", random_sequence ? "1" : "0"}};
}

} // namespace tristim
