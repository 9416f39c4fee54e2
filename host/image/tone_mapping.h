#pragma once

#include "image/image.h"
#include "spectra/colour.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tristim {

/// From scene-referred XYZ to what a display shows. Chromaticity is kept: X, Y and Z are scaled by Y'/Y.
///
/// Photographic: the global operator of Reinhard, Stark, Shirley & Ferwerda, "Photographic Tone Reproduction for
/// Digital Images", 2002 (also in Reinhard, Ward, Pattanaik & Debevec, "High Dynamic Range Imaging", 2005), with key
/// a = 0.18:
///
///     L  = 2^exposure · a · Y / Y_mean                  (equation 2)
///     Y' = L · (1 + L / L_white²) / (1 + L)             (equation 4)
///
/// Y_mean is the log-average luminance (equation 1). In place of the paper's small δ, it leaves out the pixels that
/// would be black anyway: those below 2^-13 of Y_high, the 99.5th percentile of the finite pixels with Y > 0. So a
/// black background does not change the exposure.
///
/// L_white = max(1, a · Y_high / Y_mean): the paper takes the maximum, which one outlier would make useless. It does
/// not depend on the exposure, so that raising it burns out the highlights, as in a camera. At L_white = 1, for images
/// of low contrast or without any light, the curve is the identity.
///
/// Linear: Y' = 2^exposure · Y.
struct ToneMapping {
    enum class Kind { Photographic, Linear };
    Kind kind = Kind::Photographic;
    double exposure = 0.0; ///< in stops: +1 doubles the light
};

/// A tone mapping fitted to an image.
class ToneCurve {
  public:
    ToneCurve(const XyzImage& image, const ToneMapping& mapping);

    /// Y' of Y, ascending in Y; 0 for Y <= 0.
    double operator()(double y) const;

    /// Linear sRGB in [0, 1]. Pixels with a non-finite value are black.
    Rgb display_rgb(const Xyz& xyz) const;

  private:
    double gain(double y) const;

    double scale_ = 1.0;                 ///< L / Y
    double inverse_white_squared_ = 1.0; ///< 1 / L_white²
    bool compresses_ = false;
};

/// The sRGB transfer curve (IEC 61966-2-1), from linear [0, 1] to [0, 1].
double srgb_encode(double linear);

/// The image's region in 8-bit sRGB, rows from the top.
std::vector<std::array<std::uint8_t, 3>> display_image(const XyzImage& image, const ToneCurve& curve);
std::vector<std::array<std::uint8_t, 3>> display_image(const XyzImage& image, const ToneMapping& mapping);

} // namespace tristim
