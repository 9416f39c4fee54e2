#include "sampler_oracle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <numeric>
#include <set>

namespace tristim::kernel_test {
namespace {

double total(const WavelengthBins& bins) {
    return std::accumulate(bins.begin(), bins.end(), 0.0);
}

WavelengthBins normalised(WavelengthBins bins) {
    const double sum = total(bins);
    for (double& bin : bins)
        bin /= sum;
    return bins;
}

/// (1 - d) f S/Σ f S + d f/Σ f for the defensive share d; f/Σ f where the light is none that f sees.
WavelengthBins lit(const WavelengthBins& matching, const WavelengthBins& emission) {
    WavelengthBins product{};
    std::transform(matching.begin(), matching.end(), emission.begin(), product.begin(), std::multiplies<>());
    if (total(product) == 0.0)
        return normalised(matching);
    const WavelengthBins of_light = normalised(product), plain = normalised(matching);
    for (std::size_t i = 0; i < product.size(); ++i)
        product[i] = (1.0 - defensive_share) * of_light[i] + defensive_share * plain[i];
    return product;
}

WavelengthBins x_plus_y_plus_z() {
    WavelengthBins bins{};
    for (std::size_t i = 0; i < bins.size(); ++i)
        bins[i] = cie_bins()[0][i] + cie_bins()[1][i] + cie_bins()[2][i];
    return bins;
}

// The closed form of kernels/wavelength_sampling.h.
constexpr double slope = 0.0072, centre = 538.0;

double visible_position(double lambda) {
    const auto t = [](double at) { return std::tanh(slope * (at - centre)); };
    return (t(lambda) - t(lambda_min_nm)) / (t(lambda_max_nm) - t(lambda_min_nm));
}

double visible_pdf(double lambda) {
    const double c = std::cosh(slope * (lambda - centre));
    const double range = std::tanh(slope * (lambda_max_nm - centre)) - std::tanh(slope * (lambda_min_nm - centre));
    return slope / (c * c * range);
}

} // namespace

std::size_t wavelength_bin(double lambda) {
    return static_cast<std::size_t>(std::clamp(lambda - lambda_min_nm, 0.0, lambda_bins - 1.0));
}

SamplerOracle::SamplerOracle(const Method& method, const WavelengthBins& emission) : method_(method) {
    switch (method.kind) {
    case Method::Kind::Tristimulus:
        for (const WavelengthBins& matching : cie_bins())
            rows_.push_back(normalised(matching));
        break;
    case Method::Kind::Illuminant:
        for (const WavelengthBins& matching : cie_bins())
            rows_.push_back(lit(matching, emission));
        break;
    case Method::Kind::Mixture:
        rows_ = {normalised(x_plus_y_plus_z())};
        break;
    case Method::Kind::IlluminantMixture:
        rows_ = {lit(x_plus_y_plus_z(), emission)};
        break;
    case Method::Kind::Cluster:
    case Method::Kind::Visible:
        form_ = Form::Visible;
        break;
    case Method::Kind::Spectral: // one in each of 400 equal parts, all at the same place in them
    case Method::Kind::Uniform:
    case Method::Kind::Hero:
        form_ = Form::Uniform;
        break;
    case Method::Kind::RgbBands:
    case Method::Kind::Gauss:
        ADD_FAILURE() << method.name() << " has fixed wavelengths";
    }
}

bool SamplerOracle::rotated() const {
    return method_.kind == Method::Kind::Hero || method_.kind == Method::Kind::Visible ||
           method_.kind == Method::Kind::Spectral;
}

double SamplerOracle::pdf(std::size_t row, double lambda) const {
    if (form_ == Form::Bins)
        return rows_[row][wavelength_bin(lambda)];
    return form_ == Form::Uniform ? 1.0 / lambda_bins : visible_pdf(lambda);
}

double SamplerOracle::cdf(std::size_t row, double lambda) const {
    if (form_ == Form::Uniform)
        return (lambda - lambda_min_nm) / lambda_bins;
    if (form_ == Form::Visible)
        return visible_position(lambda);
    const std::size_t bin = wavelength_bin(lambda);
    const double below =
        std::accumulate(rows_[row].begin(), rows_[row].begin() + static_cast<std::ptrdiff_t>(bin), 0.0);
    return below + rows_[row][bin] * (lambda - lambda_min_nm - static_cast<double>(bin));
}

Xyz SamplerOracle::weight(int slot, double lambda) const {
    Xyz xyz{};
    for (std::size_t c = 0; c < 3; ++c) {
        if (rows() == 1 || row(slot) == c)
            xyz[c] = cie_bins()[c][wavelength_bin(lambda)] / (cie_y_integral() * parts() * pdf(row(slot), lambda));
    }
    return xyz;
}

/// λ is rounded to 2^-15 nm, and kept 2^-14 nm away from the next bin. A table's values and positions on it have steps
/// of 2^-31, of which six dark bins in a row may need one each; other positions are cut off to 2^-24. Of the closed
/// form, OpenCL grants tanh and atanh 5 units in the last place each: two tanh and three more roundings of values below
/// 1, then atanh, of which d tanh/dx <= 1 leaves 5 · 2^-23 at most.
double SamplerOracle::cdf_error(std::size_t row, double lambda) const {
    const double of_lambda = pdf(row, lambda) * (0x1p-15 + 0x1p-14);
    return of_lambda + (form_ == Form::Visible ? (5.0 + 5.0 + 3.0 + 10.0) * unit_roundoff
                        : form_ == Form::Bins  ? 8.0 * 0x1p-31
                                               : unit_roundoff);
}

/// A pdf from a table is the difference of two values, rounded to 2^-31. That of the closed form is
/// s (1 - t²)/(last - first): t and λ belong together up to cdf_error, over which p changes by 2 s |t| dλ; one rounding
/// of 1 - t², which is 0.11 at least; and both tanh in the range of 1.75. Beside that, four roundings. The plain
/// tristimulus has no pdf in its weights.
double SamplerOracle::weight_error(std::size_t row, double lambda) const {
    constexpr double operations = 4.0 * unit_roundoff;
    if (form_ == Form::Uniform || method_.kind == Method::Kind::Tristimulus)
        return operations;
    if (form_ == Form::Bins)
        return operations + 0x1p-31 / pdf(row, lambda);
    const double off_nm = cdf_error(row, lambda) / pdf(row, lambda);
    return operations + 2.0 * slope * off_nm + unit_roundoff / 0.11 + 10.0 / 1.75 * unit_roundoff;
}

SamplerOracle::Integral SamplerOracle::integral(std::size_t channel, const WavelengthBins& light,
                                                const WavelengthBins& reflectance) const {
    const std::size_t row = rows() == 1 ? 0 : channel;
    // In half bins, over which the reflectance is linear and the pdf monotonous.
    constexpr auto halves = static_cast<std::size_t>(2 * lambda_bins);
    const auto reflectance_at = [&](std::size_t border) { // of half bins
        const double x = std::clamp(0.5 * static_cast<double>(border) - 0.5, 0.0, lambda_bins - 1.0);
        const auto left = std::min(static_cast<std::size_t>(x), static_cast<std::size_t>(lambda_bins - 2));
        const double t = x - static_cast<double>(left);
        return (1.0 - t) * reflectance[left] + t * reflectance[left + 1];
    };
    Integral result;
    double before = 0.0; // the integrand's value at the end of the last half bin
    bool any = false;
    for (std::size_t half = 0; half < halves; ++half) {
        const std::size_t bin = half / 2;
        const double low_nm = lambda_min_nm + 0.5 * static_cast<double>(half);
        const double radiance = light[bin] * cie_bins()[channel][bin] / cie_y_integral();
        const double r0 = reflectance_at(half), r1 = reflectance_at(half + 1);
        result.value += 0.5 * radiance * 0.5 * (r0 + r1);
        // The pdf within the half bin: constant, but for the closed form.
        const double p0 = pdf(row, form_ == Form::Visible ? low_nm : low_nm + 0.25);
        const double p1 = form_ == Form::Visible ? pdf(row, low_nm + 0.5) : p0;
        if (p0 <= 0.0)
            continue; // no position leads here
        // Both ends of a bin on the CDF may be off by a step of the positions.
        result.rounding += 0.5 * radiance * std::max(r0, r1) * std::min(1.0, 2.0 * unit_roundoff / std::min(p0, p1));
        const double first = radiance * r0 / p0, last = radiance * r1 / p1;
        if (any)
            result.variation += std::abs(first - before);
        result.variation +=
            radiance * (std::abs(r1 - r0) / std::min(p0, p1) + std::max(r0, r1) * std::abs(1.0 / p1 - 1.0 / p0));
        before = last;
        any = true;
    }
    return result;
}

bool heeds_light(Method::Kind kind) {
    return kind == Method::Kind::Illuminant || kind == Method::Kind::IlluminantMixture;
}

std::vector<SamplerCase> sampler_cases(const std::vector<int>& counts, const std::vector<std::string>& emissions) {
    std::vector<SamplerCase> cases;
    for (const MethodKind& kind : method_kinds()) {
        if (!kind.unbiased)
            continue;
        std::set<int> possible;
        for (const int count : counts)
            possible.insert(std::clamp(count, kind.least, kind.most));
        for (const int count : possible) {
            const Method method{kind.kind, count};
            for (const std::string& emission : emissions) {
                if (heeds_light(kind.kind))
                    cases.push_back(
                        {fmt::format("{} for {}", method.name(), emission), method, Spectrum::named(emission).bins()});
            }
            if (!heeds_light(kind.kind))
                cases.push_back({method.name(), method, {}});
        }
    }
    return cases;
}

} // namespace tristim::kernel_test
