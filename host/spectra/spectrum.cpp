#include "spectra/spectrum.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tristim {

Spectrum Spectrum::constant(double value) {
    Spectrum result;
    result.scale_ = value;
    return result;
}

Spectrum Spectrum::piecewise_linear(std::vector<double> lambda_nm, std::vector<double> values) {
    if (lambda_nm.size() != values.size())
        fail("a spectrum has {} wavelengths but {} values", lambda_nm.size(), values.size());
    if (lambda_nm.empty())
        fail("a spectrum has no samples");
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!std::isfinite(lambda_nm[i]) || !std::isfinite(values[i]))
            fail("sample {} of a spectrum, {} at {} nm, is not finite", i + 1, values[i], lambda_nm[i]);
        if (i > 0 && lambda_nm[i] <= lambda_nm[i - 1])
            fail("the wavelengths of a spectrum do not ascend: {} nm follows {} nm", lambda_nm[i], lambda_nm[i - 1]);
    }
    Spectrum result;
    result.samples_ = std::make_shared<const Samples>(Samples{std::move(lambda_nm), std::move(values)});
    result.scale_ = 1.0;
    return result;
}

Spectrum Spectrum::blackbody(double kelvin) {
    if (!(kelvin > 0.0) || !std::isfinite(kelvin))
        fail("the temperature of a blackbody must be positive and finite, not {} K", kelvin);
    // Planck's law divided by its maximum, which Wien's displacement law puts at x = h c / (λ k T) = 4.965…:
    // (x / x_max)⁵ (exp(x_max) − 1) / (exp(x) − 1). h c / k from the exact SI constants of 2019.
    constexpr double second_radiation_constant_nm_k = 1.438776877e7;
    constexpr double x_max = 4.965114231744276;
    std::vector<double> lambda_nm;
    std::vector<double> values;
    for (int lambda = 360; lambda <= 830; ++lambda) {
        const double x = second_radiation_constant_nm_k / (lambda * kelvin);
        // Above x = 700 exp(x) leaves the range of double and the value is 0 to any precision.
        lambda_nm.push_back(lambda);
        values.push_back(x > 700.0 ? 0.0 : std::pow(x / x_max, 5) * std::expm1(x_max) / std::expm1(x));
    }
    return piecewise_linear(std::move(lambda_nm), std::move(values));
}

double Spectrum::operator()(double lambda_nm) const {
    if (!samples_)
        return scale_;
    const std::vector<double>& lambda = samples_->lambda_nm;
    const std::vector<double>& value = samples_->values;
    if (!(lambda_nm >= lambda.front() && lambda_nm <= lambda.back()))
        return 0.0;
    const auto next = std::upper_bound(lambda.begin(), lambda.end(), lambda_nm);
    if (next == lambda.end())
        return scale_ * value.back();
    const auto i = static_cast<std::size_t>(next - lambda.begin());
    const double t = (lambda_nm - lambda[i - 1]) / (lambda[i] - lambda[i - 1]);
    return scale_ * (value[i - 1] + t * (value[i] - value[i - 1]));
}

double Spectrum::integral(double from_nm, double to_nm) const {
    const std::vector<double>& lambda = samples_->lambda_nm;
    const double from = std::max(from_nm, lambda.front());
    const double to = std::min(to_nm, lambda.back());
    if (!(from < to))
        return 0.0;
    double sum = 0.0;
    double left = from;
    double left_value = (*this)(from);
    auto next = std::upper_bound(lambda.begin(), lambda.end(), from);
    while (left < to) {
        const double right = std::min(*next, to);
        const double right_value = (*this)(right);
        sum += 0.5 * (left_value + right_value) * (right - left);
        left = right;
        left_value = right_value;
        ++next;
    }
    return sum;
}

double Spectrum::mean(double from_nm, double to_nm) const {
    if (!samples_)
        return scale_;
    if (from_nm == to_nm)
        return (*this)(from_nm);
    return integral(from_nm, to_nm) / (to_nm - from_nm);
}

WavelengthBins Spectrum::bins() const {
    WavelengthBins result{};
    for (int i = 0; i < lambda_bins; ++i)
        result[static_cast<std::size_t>(i)] = mean(lambda_min_nm + i, lambda_min_nm + i + 1);
    return result;
}

double Spectrum::minimum(double from_nm, double to_nm) const {
    double least = std::min((*this)(from_nm), (*this)(to_nm));
    if (!samples_)
        return least;
    const std::vector<double>& lambda = samples_->lambda_nm;
    for (std::size_t i = 0; i < lambda.size(); ++i) {
        if (lambda[i] >= from_nm && lambda[i] <= to_nm)
            least = std::min(least, scale_ * samples_->values[i]);
    }
    return least;
}

bool Spectrum::is_constant() const {
    if (!samples_ || scale_ == 0.0)
        return true;
    const std::vector<double>& lambda = samples_->lambda_nm;
    const double value = (*this)(lambda_min_nm);
    if ((*this)(lambda_max_nm) != value)
        return false;
    for (std::size_t i = 0; i < lambda.size(); ++i) {
        if (lambda[i] >= lambda_min_nm && lambda[i] <= lambda_max_nm && scale_ * samples_->values[i] != value)
            return false;
    }
    return true;
}

std::array<double, 2> Spectrum::range_nm() const {
    if (!samples_)
        return {lambda_min_nm, lambda_max_nm};
    return {samples_->lambda_nm.front(), samples_->lambda_nm.back()};
}

Spectrum Spectrum::scaled(double factor) const {
    Spectrum result = *this;
    result.scale_ *= factor;
    return result;
}

} // namespace tristim
