#include "image/error_map.h"

#include "base/round_numbers.h"
#include "image/compare_images.h"
#include "image/write_image.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <numbers>

namespace tristim {
namespace {

constexpr double percentile = 0.99;

/// Relative, of a value's rounding to float: a round number is not rounded up to the next for it.
constexpr double float_rounding = 1e-6;

} // namespace

std::vector<float> pixel_errors(const XyzImage& image, const XyzImage& reference) {
    check_same_pixels(image, reference);
    std::vector<float> errors;
    errors.reserve(image.xyz.size());
    for (std::size_t i = 0; i < image.xyz.size(); ++i) {
        double squares = 0.0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double difference = static_cast<double>(image.xyz[i][c]) - static_cast<double>(reference.xyz[i][c]);
            squares += difference * difference;
        }
        errors.push_back(static_cast<float>(std::sqrt(squares / 3.0)));
    }
    return errors;
}

double error_map_scale(std::span<const std::vector<float>> maps) {
    std::vector<float> errors;
    for (const std::vector<float>& map : maps)
        std::copy_if(map.begin(), map.end(), std::back_inserter(errors),
                     [](float error) { return error > 0.0f && std::isfinite(error); });
    if (errors.empty())
        return 0.0;
    const auto rank = static_cast<std::ptrdiff_t>(std::ceil(percentile * static_cast<double>(errors.size()))) - 1;
    std::nth_element(errors.begin(), errors.begin() + rank, errors.end());
    const double error = static_cast<double>(errors[static_cast<std::size_t>(rank)]);
    return round_number(round_number_above(error / (1.0 + float_rounding)));
}

double error_map_position(double error, double scale) {
    if (!std::isfinite(error))
        return 1.0;
    if (error <= 0.0)
        return 0.0;
    return std::clamp(1.0 + std::log10(error / scale) / error_map_decades, 0.0, 1.0);
}

Rgb error_map_colour(double position) {
    constexpr double start = 0.5, rotations = -1.5, hue = 1.0; // γ = 1: no power of the position
    const double lightness = std::clamp(position, 0.0, 1.0);
    const double angle = 2.0 * std::numbers::pi * (start / 3.0 + rotations * lightness);
    const double amplitude = hue * lightness * (1.0 - lightness) / 2.0;
    const double cosine = amplitude * std::cos(angle);
    const double sine = amplitude * std::sin(angle);
    return {std::clamp(lightness - 0.14861 * cosine + 1.78277 * sine, 0.0, 1.0),
            std::clamp(lightness - 0.29227 * cosine - 0.90649 * sine, 0.0, 1.0),
            std::clamp(lightness + 1.97294 * cosine, 0.0, 1.0)};
}

void write_error_map(const std::string& png_path, const XyzImage& image, const XyzImage& reference, double scale) {
    std::vector<std::array<std::uint8_t, 3>> pixels;
    for (const float error : pixel_errors(image, reference)) {
        std::array<std::uint8_t, 3> pixel{};
        const Rgb colour = error_map_colour(error_map_position(static_cast<double>(error), scale));
        for (std::size_t c = 0; c < 3; ++c)
            pixel[c] = static_cast<std::uint8_t>(std::lround(255.0 * colour[c]));
        pixels.push_back(pixel);
    }
    write_png(png_path, image.region.width, image.region.height, pixels);
}

} // namespace tristim
