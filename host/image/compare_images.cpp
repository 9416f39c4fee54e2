#include "image/compare_images.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

namespace tristim {
namespace {

std::string describe(const Region& r) {
    return fmt::format("{},{},{},{}", r.x, r.y, r.x + r.width, r.y + r.height);
}

std::string describe(const XyzImage& image) {
    const bool is_whole = image.region == Region{0, 0, image.full_width, image.full_height};
    return fmt::format("{}x{}{}", image.full_width, image.full_height,
                       is_whole ? "" : " with pixels in " + describe(image.region));
}

std::size_t index_of(const XyzImage& image, int x, int y) {
    return static_cast<std::size_t>(y - image.region.y) * static_cast<std::size_t>(image.region.width) +
           static_cast<std::size_t>(x - image.region.x);
}

double peak_signal_to_noise(double peak, double mse) {
    if (mse == 0.0)
        return std::numeric_limits<double>::infinity();
    return peak > 0.0 ? 10.0 * std::log10(peak * peak / mse) : std::numeric_limits<double>::quiet_NaN();
}

} // namespace

ImageDifference compare_images(const XyzImage& a, const XyzImage& b, const Region& region) {
    if (!contains(a.region, region) || !contains(b.region, region))
        fail("the region {} is not within both images: the first is {}, the second {}", describe(region), describe(a),
             describe(b));
    Xyz squares{};
    double relative_squares = 0.0;
    double peak = 0.0;
    ImageDifference difference;
    for (int y = region.y; y < region.y + region.height; ++y) {
        for (int x = region.x; x < region.x + region.width; ++x) {
            const auto& pixel_a = a.xyz[index_of(a, x, y)];
            const auto& pixel_b = b.xyz[index_of(b, x, y)];
            for (std::size_t c = 0; c < 3; ++c) {
                const double value_a = pixel_a[c];
                const double value_b = pixel_b[c];
                const double square = (value_a - value_b) * (value_a - value_b);
                squares[c] += square;
                relative_squares += square / (value_b * value_b + rel_mse_epsilon);
                difference.mean_xyz_a[c] += value_a;
                difference.mean_xyz_b[c] += value_b;
            }
            peak = std::max(peak, static_cast<double>(pixel_b[1]));
        }
    }
    const double n = region.pixels();
    difference.rmse = std::sqrt((squares[0] + squares[1] + squares[2]) / (3.0 * n));
    difference.rel_mse = relative_squares / (3.0 * n);
    difference.psnr = peak_signal_to_noise(peak, squares[1] / n);
    for (std::size_t c = 0; c < 3; ++c) {
        difference.mean_xyz_a[c] /= n;
        difference.mean_xyz_b[c] /= n;
    }
    difference.pixels = region.pixels();
    return difference;
}

void check_same_pixels(const XyzImage& a, const XyzImage& b) {
    if (a.full_width != b.full_width || a.full_height != b.full_height || a.region != b.region)
        fail("the images differ in size: the first is {}, the second {}; --region compares a part that both hold",
             describe(a), describe(b));
}

ImageDifference compare_images(const XyzImage& a, const XyzImage& b) {
    check_same_pixels(a, b);
    return compare_images(a, b, a.region);
}

} // namespace tristim
