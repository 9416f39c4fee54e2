#pragma once

#include "image/image.h"
#include "render/flat_scene.h"
#include "shared_types.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tristim {

/// The image after some passes: mean XYZ of each pixel and the variance of that mean, pixels in rows from the top.
struct FilmImage {
    int full_width = 0; ///< of the whole image, of which this may be a region
    int full_height = 0;
    Region region;
    std::vector<std::array<float, 3>> xyz;      ///< radiance-like: a white of radiance 1 has Y = 1
    std::vector<std::array<float, 3>> variance; ///< of xyz, from the spread over the passes; 0 after one pass, infinite
                                                ///< where a sample was beyond 1e14
    std::uint64_t rejected_samples = 0;         ///< values that were not finite, as far as they were counted
    std::uint64_t passes = 0;
};

/// The sums of a pixel's samples and of their squares, in X, Y and Z.
std::array<double, 3> sample_sums(const FilmPixel& pixel);
std::array<double, 3> square_sums(const FilmPixel& pixel);

/// Rays traced for a pixel.
std::uint64_t camera_rays(const FilmPixel& pixel);
std::uint64_t shadow_rays(const FilmPixel& pixel);

/// Adds the passes of another film of the same pixels to `film`. Whatever passes are in which of several films, and in
/// whatever order these are added up, the developed means are the same, and variances but for rounding. What --radius
/// statistics keeps is not summed.
void add_film(std::span<FilmPixel> film, std::span<const FilmPixel> more);

/// The image alone.
XyzImage xyz_image(FilmImage film);

/// Means and variances from the running sums of kernels/film.cl, and the samples that it rejected.
FilmImage develop_film(const std::vector<FilmPixel>& pixels, int full_width, int full_height, const Region& region);

/// The image after the passes of both, which are other ones and show the same pixels; either may have none. Means and
/// variances are pooled as Chan, Golub & LeVeque, "Updating Formulae and a Pairwise Algorithm for Computing Sample
/// Variances", 1979, equations 2.1 do. A sample that was rejected counts as if it were the mean of its image.
FilmImage merge(const FilmImage& a, const FilmImage& b);

} // namespace tristim
