#include "render/spectrum_table.h"

#include "spectra/colour.h"

#include <algorithm>

namespace tristim {
namespace {

using Bins = std::array<double, lambda_bins>;

Rgb rgb_of(const Bins& bins) {
    Xyz xyz{};
    for (std::size_t channel = 0; channel < 3; ++channel) {
        for (std::size_t i = 0; i < bins.size(); ++i)
            xyz[channel] += cie_bins()[channel][i] * bins[i] / cie_y_integral();
    }
    return xyz_to_rgb(xyz);
}

/// The wavelength that stands for each band: the centroid, in nm, of the positive part of its colour matching function.
std::array<double, 3> band_wavelengths() {
    std::array<double, 3> weighted{}, sum{};
    for (std::size_t i = 0; i < lambda_bins; ++i) {
        const Rgb rgb = xyz_to_rgb({cie_bins()[0][i], cie_bins()[1][i], cie_bins()[2][i]});
        for (std::size_t c = 0; c < 3; ++c) {
            sum[c] += std::max(rgb[c], 0.0);
            weighted[c] += std::max(rgb[c], 0.0) * (lambda_min_nm + static_cast<double>(i) + 0.5);
        }
    }
    return {weighted[0] / sum[0], weighted[1] / sum[1], weighted[2] / sum[2]};
}

Rgb band_values(const Spectrum& spectrum, SpectrumTable::Use use) {
    Bins bins = spectrum.bins();
    if (use == SpectrumTable::Use::Emission) {
        Rgb rgb = rgb_of(bins);
        for (double& value : rgb)
            value = std::max(value, 0.0); // an RGB renderer has no negative light
        return rgb;
    }
    static const Bins white = Spectrum::named("stdillum-D65").bins();
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

std::vector<float> sampler_table(const Method& method) {
    std::vector<float> table;
    const auto append = [&table](double value) { table.push_back(static_cast<float>(value)); };
    switch (method.kind) {
    case Method::Kind::Tristimulus: {
        std::array<double, 3> integrals{};
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const Bins& bins = cie_bins()[channel];
            for (const double value : bins)
                integrals[channel] += value;
            double sum = 0.0;
            append(0.0);
            for (const double value : bins)
                append((sum += value) / integrals[channel]);
        }
        for (const double integral : integrals)
            append(integral / cie_y_integral());
        break;
    }
    case Method::Kind::Spectral:
        for (const Bins& bins : cie_bins()) {
            for (const double value : bins)
                append(value / cie_y_integral());
        }
        break;
    case Method::Kind::RgbBands:
        for (const auto& row : rgb_to_xyz_matrix()) {
            for (const double value : row)
                append(value);
        }
        for (const double wavelength : band_wavelengths())
            append(wavelength);
        break;
    }
    return table;
}

} // namespace tristim
