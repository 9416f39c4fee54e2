#include "selftest/spectrum_oracle.h"

#include "render/sampler_table.h"
#include "spectra/colour.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tristim::selftest {
namespace {

double total(const WavelengthBins& bins) {
    return std::accumulate(bins.begin(), bins.end(), 0.0);
}

/// f, or for samplers that follow the light (1 - d) f S/Σ f S + d f/Σ f with the defensive share d.
std::vector<double> cumulative(const WavelengthBins& matching, const WavelengthBins* emission) {
    WavelengthBins lit = matching;
    for (std::size_t i = 0; emission != nullptr && i < lit.size(); ++i)
        lit[i] *= (*emission)[i];
    const double kept = emission == nullptr ? 0.0 : total(lit) > 0.0 ? defensive_share : 1.0;
    const double of_light = total(lit) > 0.0 ? (1.0 - kept) / total(lit) : 0.0;
    std::vector<double> borders{0.0};
    for (std::size_t i = 0; i < lit.size(); ++i)
        borders.push_back(borders.back() + of_light * lit[i] + kept * matching[i] / total(matching));
    return borders;
}

} // namespace

WavelengthOracle::WavelengthOracle(Method::Kind kind, const WavelengthBins& emission) : kind_(kind) {
    const bool heeds_light = kind == Method::Kind::Illuminant || kind == Method::Kind::IlluminantMixture;
    const WavelengthBins* light = heeds_light ? &emission : nullptr;
    WavelengthBins all{};
    for (const WavelengthBins& matching : cie_bins()) {
        if (kind == Method::Kind::Tristimulus || kind == Method::Kind::Illuminant)
            cdfs_.push_back(cumulative(matching, light));
        std::transform(all.begin(), all.end(), matching.begin(), all.begin(), std::plus<>());
    }
    if (kind == Method::Kind::Mixture || kind == Method::Kind::IlluminantMixture)
        cdfs_.push_back(cumulative(all, light));
}

/// p(λ) ∝ 1/cosh²(s (λ - c)) (Radziszewski et al. 2009), whose integral is tanh(s (λ - c))/s: here by bisection.
double WavelengthOracle::visible_lambda(double u) const {
    const auto integral = [](double lambda) { return std::tanh(0.0072 * (lambda - 538.0)); };
    const double first = integral(lambda_min_nm), last = integral(lambda_max_nm);
    double low = lambda_min_nm, high = lambda_max_nm;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (integral(middle) - first <= u * (last - first) ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

double WavelengthOracle::lambda(std::size_t row, double u) const {
    u = std::clamp(u, 0.0, 1.0);
    if (kind_ == Method::Kind::Cluster || kind_ == Method::Kind::Visible)
        return visible_lambda(u);
    if (cdfs_.empty())
        return lambda_min_nm + lambda_bins * u;
    const std::vector<double>& cdf = cdfs_[row];
    // Of bins that end where the next begins, those without any probability are passed over.
    const auto next = std::upper_bound(cdf.begin(), cdf.end(), u);
    if (next == cdf.end())
        return lambda_max_nm;
    const double below = *(next - 1);
    return lambda_min_nm + static_cast<double>(next - cdf.begin() - 1) + (u - below) / (*next - below);
}

double table_value(const std::vector<float>& bins, bool smooth, double lambda) {
    const double x = lambda - lambda_min_nm;
    const auto last = static_cast<double>(bins.size() - 1);
    if (!smooth)
        return bins[static_cast<std::size_t>(std::clamp(std::floor(x), 0.0, last))];
    const double centred = std::clamp(x - 0.5, 0.0, last);
    const auto left = static_cast<std::size_t>(std::min(std::floor(centred), last - 1.0));
    const double t = centred - static_cast<double>(left);
    return (1.0 - t) * bins[left] + t * bins[left + 1];
}

} // namespace tristim::selftest
