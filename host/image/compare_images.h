#pragma once

#include "image/image.h"
#include "spectra/colour.h"

namespace tristim {

/// ε of relMSE, the value of Rousselle, Knaus & Zwicker, "Adaptive Sampling and Reconstruction using Greedy Error
/// Minimization", 2011: the squared XYZ at which the measure turns from relative to absolute.
inline constexpr double rel_mse_epsilon = 0.01;

/// How an image a differs from a reference b. All sums are over pixels and the channels X, Y, Z.
struct ImageDifference {
    double rmse = 0.0;    ///< sqrt(mean of (a-b)²), the paper's equation 12, in units of XYZ
    double rel_mse = 0.0; ///< mean of (a-b)² / (b² + ε), without unit
    double psnr = 0.0; ///< dB: 10 log10(peak² / mean of (a-b)² over Y), peak = largest Y of b; infinite if the Y are
                       ///< equal, else not a number if the reference is black
    Xyz mean_xyz_a{};
    Xyz mean_xyz_b{};
    int pixels = 0;
};

/// The difference within a region of the whole image. Throws Error unless both images hold all of it.
ImageDifference compare_images(const XyzImage& a, const XyzImage& b, const Region& region);

/// Throws Error unless both have the same size and region.
void check_same_pixels(const XyzImage& a, const XyzImage& b);

/// The difference in all pixels. Throws Error unless both have the same size and region.
ImageDifference compare_images(const XyzImage& a, const XyzImage& b);

} // namespace tristim
