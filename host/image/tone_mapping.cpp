#include "image/tone_mapping.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace tristim {
namespace {

constexpr double key = 0.18;
constexpr double highlight_quantile = 0.995;
constexpr double darkest_visible = 0x1p-13; ///< of the highlights; 8-bit sRGB's first step is 1/3300 of white

template <typename Number>
bool is_finite(const std::array<Number, 3>& pixel) {
    return std::all_of(pixel.begin(), pixel.end(), [](Number value) { return std::isfinite(value); });
}

struct LuminanceRange {
    double log_average = 0.0; ///< 0 if no pixel is lit
    double highlight = 0.0;
};

/// Exposures of thousands of stops leave the range of double; what they show is black or white all the same.
double usable_scale(double scale) {
    using Double = std::numeric_limits<double>;
    return std::clamp(scale, Double::min(), Double::max());
}

LuminanceRange luminance_range(const XyzImage& image) {
    std::vector<double> lit;
    lit.reserve(image.xyz.size());
    for (const auto& pixel : image.xyz) {
        if (is_finite(pixel) && pixel[1] > 0.0f)
            lit.push_back(pixel[1]);
    }
    if (lit.empty())
        return {};
    const auto rank = static_cast<std::ptrdiff_t>(highlight_quantile * static_cast<double>(lit.size() - 1));
    std::nth_element(lit.begin(), lit.begin() + rank, lit.end());
    const double highlight = lit[static_cast<std::size_t>(rank)];

    double sum = 0.0;
    std::size_t count = 0;
    for (const double y : lit) {
        if (y < darkest_visible * highlight)
            continue;
        sum += std::log(y);
        ++count;
    }
    return {std::exp(sum / static_cast<double>(count)), highlight};
}

} // namespace

ToneCurve::ToneCurve(const XyzImage& image, const ToneMapping& mapping)
    : scale_(usable_scale(std::exp2(mapping.exposure))), compresses_(mapping.kind == ToneMapping::Kind::Photographic) {
    if (!compresses_)
        return;
    const LuminanceRange range = luminance_range(image);
    if (range.log_average <= 0.0)
        return;
    const double key_scale = key / range.log_average;
    scale_ = usable_scale(scale_ * key_scale);
    const double white = std::max(1.0, key_scale * range.highlight);
    inverse_white_squared_ = 1.0 / (white * white);
}

/// Y' / Y, which stays finite where Y vanishes and where scale_ · Y overflows.
double ToneCurve::gain(double y) const {
    if (!compresses_)
        return scale_;
    const double l = scale_ * std::max(y, 0.0);
    return scale_ * (inverse_white_squared_ + (1.0 - inverse_white_squared_) / (1.0 + l));
}

double ToneCurve::operator()(double y) const {
    return gain(y) * std::max(y, 0.0);
}

Rgb ToneCurve::display_rgb(const Xyz& xyz) const {
    if (!is_finite(xyz))
        return {};
    Rgb rgb = xyz_to_rgb(xyz);
    const double factor = gain(xyz[1]);
    for (double& channel : rgb)
        channel = std::clamp(factor * channel, 0.0, 1.0);
    return rgb;
}

double srgb_encode(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

std::vector<std::array<std::uint8_t, 3>> display_image(const XyzImage& image, const ToneCurve& curve) {
    std::vector<std::array<std::uint8_t, 3>> pixels;
    pixels.reserve(image.xyz.size());
    for (const auto& [x, y, z] : image.xyz) {
        const Rgb rgb = curve.display_rgb({x, y, z});
        std::array<std::uint8_t, 3> pixel{};
        for (std::size_t c = 0; c < 3; ++c)
            pixel[c] = static_cast<std::uint8_t>(std::lround(255.0 * srgb_encode(rgb[c])));
        pixels.push_back(pixel);
    }
    return pixels;
}

std::vector<std::array<std::uint8_t, 3>> display_image(const XyzImage& image, const ToneMapping& mapping) {
    return display_image(image, ToneCurve(image, mapping));
}

} // namespace tristim
