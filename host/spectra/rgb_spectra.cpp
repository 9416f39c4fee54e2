#include "base/error.h"
#include "spectra/rgb_upsampling.h"
#include "spectra/spectrum.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace tristim {

namespace {

/// m with rgb / m in [0, 1/2]³, as in pbrt-v4, where the sigmoid is far from its ends and the smoothest reflectance
/// stays below 1 by itself.
double scale_of_unbounded(const Rgb& rgb) {
    for (const double value : rgb) {
        if (!(value >= 0.0) || !std::isfinite(value))
            fail("an RGB colour must be finite and not negative, not ({}, {}, {})", rgb[0], rgb[1], rgb[2]);
    }
    return 2.0 * std::max({rgb[0], rgb[1], rgb[2]});
}

/// The reflectance of a colour in [0, 1]³: constant if it is grey.
Spectrum reflectance(const Rgb& rgb, RgbUpsampling upsampling) {
    if (rgb[0] == rgb[1] && rgb[1] == rgb[2])
        return Spectrum::constant(rgb[0]);
    return upsampling == RgbUpsampling::Meng ? meng_reflectance(rgb) : jakob_hanika_reflectance(rgb);
}

} // namespace

Spectrum Spectrum::rgb_albedo(const Rgb& rgb, RgbUpsampling upsampling) {
    for (const double value : rgb) {
        if (!(value >= 0.0 && value <= 1.0))
            fail("an RGB reflectance must lie in [0, 1], not ({}, {}, {})", rgb[0], rgb[1], rgb[2]);
    }
    return reflectance(rgb, upsampling);
}

Spectrum Spectrum::rgb_unbounded(const Rgb& rgb, RgbUpsampling upsampling) {
    const double m = scale_of_unbounded(rgb);
    return m > 0.0 ? reflectance({rgb[0] / m, rgb[1] / m, rgb[2] / m}, upsampling).scaled(m) : constant(0.0);
}

Spectrum Spectrum::rgb_illuminant(const Rgb& rgb, RgbUpsampling upsampling) {
    const Spectrum colour = rgb_unbounded(rgb, upsampling);
    if (!colour.samples_)
        return rgb_illuminant_white().scaled(colour.scale_);
    // The D65 table is linear between multiples of 5 nm, so whole nanometres hold all its samples.
    const Spectrum white = rgb_illuminant_white();
    std::vector<double> lambda_nm;
    std::vector<double> values;
    for (const double lambda : colour.samples_->lambda_nm) {
        lambda_nm.push_back(lambda);
        values.push_back(colour(lambda) * white(lambda));
    }
    return piecewise_linear(std::move(lambda_nm), std::move(values));
}

Spectrum Spectrum::rgb_illuminant_white() {
    return named("stdillum-D65");
}

} // namespace tristim
