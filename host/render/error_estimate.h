#pragma once

#include "render/sums.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace tristim {

/// How far a render is from the truth, as far as it can tell by itself.
struct ErrorEstimate {
    /// Root mean squares over pixels and X, Y, Z, as `tristim compare` has them, over the mean Y of the image.
    double rmse = 0.0;  ///< of both
    double noise = 0.0; ///< standard error of the mean over the passes; infinite after one
    double bias = 0.0;  ///< what the search radius blurs

    bool complete = false; ///< false: there is no estimate of bias, and `noise` is from the plain spread of the passes,
                           ///< which is an upper limit: passes are stratified against each other
    std::vector<std::array<float, 3>> pixel_noise; ///< standard error, units of XYZ; empty unless complete
    std::vector<std::array<float, 3>> pixel_bias;  ///< signed, units of XYZ; empty unless complete
};

/// Noise. Wavelengths, camera rays and photons come from Sobol' sequences over the passes, so that the mean of n passes
/// has a variance v(n) that falls faster than 1/n: from the spread of single passes it would come out up to fifty times
/// too large. What two halves of a block of 2 B passes differ by tells v(B) − v(2B), for B = 1, 2, 4, … up to n/2 (the
/// Haar wavelet variance, also known as Allan's; Percival 1995, "On estimation of the wavelet variance", Biometrika
/// 82(3)). The covariance of two passes of a sequence that is scrambled digit by digit depends on the xor of their
/// numbers alone, so the v(2^h) together give v of any passes (error_contrasts.h): a mean of 48 has a larger error than
/// a power law between 32 and 64 would have it. Beyond what was seen, a mixture of 1/n and n^-1.75 is fitted, largest
/// blocks first. Squares are means over 7×7 pixels, since pixels that a caustic reaches seldom show no spread while it
/// has not come.
///
/// Bias. To first order the density within a radius r is off by r² times a Laplacian (Hachisuka, Jarosz & Jensen 2010,
/// "A Progressive Error Estimation Framework for Photon Density Estimation", equation 10; Knaus & Zwicker 2011, section
/// 4), so that twice the difference to the density within r/√2 estimates it without bias. What the noise of that
/// estimate adds to its square is taken off, and a root mean square that is not clearly above the noise that then
/// remains counts for less or nothing.
///
/// `width` is that of the region in pixels. Without sums.error only the upper limit of the noise is told.
ErrorEstimate estimate_error(const RenderSums& sums, int width);

/// "estimated RMSE 0.0031 (noise 0.0024, bias 0.0019)", or "noise at most 0.0024".
std::string describe(const ErrorEstimate& estimate);

} // namespace tristim
