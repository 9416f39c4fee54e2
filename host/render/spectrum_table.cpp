#include "render/spectrum_table.h"

#include "spectra/colour.h"

#include <algorithm>

namespace tristim {
namespace {

Rgb rgb_of(const WavelengthBins& bins) {
    Xyz xyz{};
    for (std::size_t channel = 0; channel < 3; ++channel) {
        for (std::size_t i = 0; i < bins.size(); ++i)
            xyz[channel] += cie_bins()[channel][i] * bins[i] / cie_y_integral();
    }
    return xyz_to_rgb(xyz);
}

Rgb band_values(const Spectrum& spectrum, SpectrumTable::Use use) {
    WavelengthBins bins = spectrum.bins();
    if (use == SpectrumTable::Use::Emission) {
        Rgb rgb = rgb_of(bins);
        for (double& value : rgb)
            value = std::max(value, 0.0); // an RGB renderer has no negative light
        return rgb;
    }
    static const WavelengthBins white = Spectrum::named("stdillum-D65").bins();
    for (std::size_t i = 0; i < bins.size(); ++i)
        bins[i] *= white[i];
    const Rgb weighted = rgb_of(bins);
    const Rgb reference = rgb_of(white);
    Rgb rgb{};
    for (std::size_t c = 0; c < 3; ++c) {
        rgb[c] = weighted[c] / reference[c];
        if (use == SpectrumTable::Use::Reflectance)
            rgb[c] = std::clamp(rgb[c], 0.0, 1.0); // saturated colours lie outside sRGB
    }
    return rgb;
}

} // namespace

int SpectrumTable::add(const Spectrum& spectrum, Use use) {
    entries_.push_back({spectrum, use});
    return rows() - 1;
}

std::vector<float> SpectrumTable::values(const Method& method) const {
    std::vector<float> values;
    const auto append = [&values](const auto& row) {
        for (const double value : row)
            values.push_back(static_cast<float>(value));
    };
    for (const Entry& entry : entries_) {
        if (method.kind == Method::Kind::RgbBands)
            append(band_values(entry.spectrum, entry.use));
        else
            append(entry.spectrum.bins());
    }
    return values;
}

std::vector<int> SpectrumTable::smooth() const {
    std::vector<int> smooth;
    for (const Entry& entry : entries_)
        smooth.push_back(entry.use == Use::Emission ? 0 : 1);
    return smooth;
}

} // namespace tristim
