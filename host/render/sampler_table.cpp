#include "render/sampler_table.h"

#include "spectra/colour.h"
#include "spectra/gauss_rule.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>

namespace tristim {
namespace {

double sum(const WavelengthBins& bins) {
    return std::accumulate(bins.begin(), bins.end(), 0.0);
}

/// x̄ + ȳ + z̄
WavelengthBins all_matching() {
    WavelengthBins bins{};
    for (const WavelengthBins& of_channel : cie_bins())
        std::transform(bins.begin(), bins.end(), of_channel.begin(), bins.begin(), std::plus<>());
    return bins;
}

/// The wavelength that stands for each band: the centroid, in nm, of the positive part of its colour matching function.
std::array<double, 3> band_wavelengths() {
    std::array<double, 3> weighted{}, total{};
    for (std::size_t i = 0; i < lambda_bins; ++i) {
        const Rgb rgb = xyz_to_rgb({cie_bins()[0][i], cie_bins()[1][i], cie_bins()[2][i]});
        for (std::size_t c = 0; c < 3; ++c) {
            total[c] += std::max(rgb[c], 0.0);
            weighted[c] += std::max(rgb[c], 0.0) * (lambda_min_nm + static_cast<double>(i) + 0.5);
        }
    }
    return {weighted[0] / total[0], weighted[1] / total[1], weighted[2] / total[2]};
}

class Table {
  public:
    void append(double value) { values.push_back(static_cast<float>(value)); }
    template <typename List>
    void append_all(const List& list) {
        for (const double value : list)
            append(value);
    }
    /// lambda_bins + 1 values from 0 to 2^31, of each the digits above the last eight, then these. Every bin that is
    /// not empty has a share, so that the sampler leaves out no light.
    void append_cdf(const WavelengthBins& bins) {
        constexpr double whole = 0x1p31;
        const double total = sum(bins);
        auto left = std::count_if(bins.begin(), bins.end(), [](double value) { return value > 0.0; });
        double below = 0.0;
        std::int64_t border = 0;
        append_border(border);
        for (const double value : bins) {
            below += value;
            if (value > 0.0) {
                --left;
                border = std::clamp<std::int64_t>(std::llround(below / total * whole), border + 1,
                                                  static_cast<std::int64_t>(whole) - left);
            }
            append_border(border);
        }
    }

    std::vector<float> values;

  private:
    void append_border(std::int64_t border) {
        append(static_cast<double>(border >> 8));
        append(static_cast<double>(border & 255));
    }
};

} // namespace

WavelengthBins illuminant_pdf(const WavelengthBins& matching, const WavelengthBins& emission) {
    WavelengthBins lit{};
    std::transform(matching.begin(), matching.end(), emission.begin(), lit.begin(), std::multiplies<>());
    const double total = sum(lit);
    const double plain_total = sum(matching);
    const double plain_share = total > 0.0 ? defensive_share : 1.0;
    WavelengthBins pdf{};
    for (std::size_t i = 0; i < pdf.size(); ++i) {
        pdf[i] = plain_share * matching[i] / plain_total;
        if (total > 0.0)
            pdf[i] += (1.0 - plain_share) * lit[i] / total;
    }
    return pdf;
}

std::vector<float> sampler_table(const Method& method, const WavelengthBins& emission) {
    Table table;
    for (const WavelengthBins& of_channel : cie_bins()) {
        for (const double value : of_channel)
            table.append(value / cie_y_integral());
    }
    switch (method.kind) {
    case Method::Kind::Tristimulus:
        for (const WavelengthBins& of_channel : cie_bins())
            table.append_cdf(of_channel);
        for (const WavelengthBins& of_channel : cie_bins())
            table.append(sum(of_channel) / cie_y_integral());
        break;
    case Method::Kind::RgbBands:
        for (const auto& row : rgb_to_xyz_matrix())
            table.append_all(row);
        table.append_all(band_wavelengths());
        break;
    case Method::Kind::Gauss: {
        const QuadratureRule rule = gauss_rule(method.count);
        table.append_all(rule.wavelengths);
        for (std::size_t channel = 0; channel < 3; ++channel) {
            for (const Xyz& weight : rule.weights)
                table.append(weight[channel]);
        }
        break;
    }
    case Method::Kind::Mixture:
        table.append_cdf(all_matching());
        break;
    case Method::Kind::Illuminant:
        for (const WavelengthBins& of_channel : cie_bins())
            table.append_cdf(illuminant_pdf(of_channel, emission));
        break;
    case Method::Kind::IlluminantMixture:
        table.append_cdf(illuminant_pdf(all_matching(), emission));
        break;
    case Method::Kind::Spectral:
    case Method::Kind::Uniform:
    case Method::Kind::Cluster:
    case Method::Kind::Hero:
    case Method::Kind::Visible:
        break;
    }
    return std::move(table.values);
}

} // namespace tristim
