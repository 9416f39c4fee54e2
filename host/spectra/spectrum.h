#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace tristim {

/// The visible range of every wavelength sampler, in nm, and its 1 nm bins (the paper's range, section 4).
inline constexpr double lambda_min_nm = 380.0;
inline constexpr double lambda_max_nm = 780.0;
inline constexpr int lambda_bins = 400;

/// A value for each bin of 1 nm.
using WavelengthBins = std::array<double, lambda_bins>;

/// How RGB colours become reflectances, from which their spectra follow (rgb_upsampling.h).
enum class RgbUpsampling {
    JakobHanika, ///< the sigmoid of a quadratic (Jakob & Hanika 2019)
    Meng         ///< the smoothest one within [0, 1] (Meng et al. 2015)
};

/// A spectral distribution: a function of the wavelength in nm. Immutable and cheap to copy.
/// The unit of the value is the user's: reflectance, refractive index, or W·m⁻²·sr⁻¹·nm⁻¹. By default the constant 0.
/// Spectra that are computed from formulas (blackbody, rgb_…) are sampled every 1 nm from 360 to 830 nm.
class Spectrum {
  public:
    /// The same value at every wavelength.
    static Spectrum constant(double value);

    /// Piecewise linear between samples. Outside [lambda_nm.front(), lambda_nm.back()] the value is 0 as in pbrt-v4.
    /// Throws Error if the lists differ in length, are empty, hold a non-finite value or do not ascend.
    static Spectrum piecewise_linear(std::vector<double> lambda_nm, std::vector<double> values);

    /// Planck's law at a temperature in kelvin, scaled to a maximum of 1 (pbrt-v4's "blackbody"). Throws Error unless
    /// the temperature is positive and finite.
    static Spectrum blackbody(double kelvin);

    /// Smooth reflectance of a linear sRGB colour in [0,1]³, fitted in double precision so that it reproduces the
    /// colour under D65; greys are constant. Throws Error for values outside [0,1].
    static Spectrum rgb_albedo(const std::array<double, 3>& rgb, RgbUpsampling = RgbUpsampling::JakobHanika);

    /// Emission of a linear sRGB colour ≥ 0: m · albedo(rgb/m) · D65 with m = 2 max(rgb), as pbrt-v4's
    /// RGBIlluminantSpectrum. `rgb_illuminant_white()` is the D65 factor alone, by which pbrt normalises such lights.
    static Spectrum rgb_illuminant(const std::array<double, 3>& rgb, RgbUpsampling = RgbUpsampling::JakobHanika);
    static Spectrum rgb_illuminant_white();

    /// Unbounded positive colour: m · albedo(rgb/m), m = 2 max(rgb), as pbrt-v4's RGBUnboundedSpectrum.
    static Spectrum rgb_unbounded(const std::array<double, 3>& rgb, RgbUpsampling = RgbUpsampling::JakobHanika);

    /// A named spectrum ("glass-BK7", "metal-Au-k", "stdillum-D65", …). The illuminants ("stdillum-…", "illum-…") are
    /// scaled to Y = 1, as in pbrt-v4. Throws Error naming near matches if unknown.
    static Spectrum named(const std::string& name);

    /// Reads pairs "lambda value" of a .spd file; '#' starts a comment. Throws Error with file and line.
    static Spectrum read_spd(const std::string& path);

    /// The value at a wavelength in nm.
    double operator()(double lambda_nm) const;

    /// The exact mean over [from_nm, to_nm]; lines narrower than the interval keep their energy.
    double mean(double from_nm, double to_nm) const;

    /// Means over the 400 bins [380+i, 381+i) nm.
    WavelengthBins bins() const;

    /// The smallest value over [from_nm, to_nm].
    double minimum(double from_nm, double to_nm) const;

    /// True if the value is the same at every visible wavelength.
    bool is_constant() const;

    /// The wavelengths in nm between which the spectrum is given (piecewise linear ones), else the visible range.
    std::array<double, 2> range_nm() const;

    Spectrum scaled(double factor) const;

  private:
    struct Samples {
        std::vector<double> lambda_nm;
        std::vector<double> values;
    };

    double integral(double from_nm, double to_nm) const;

    std::shared_ptr<const Samples> samples_; // null: constant
    double scale_ = 0.0;                     // of the samples; the value itself if constant
};

/// Names that Spectrum::named() knows, sorted.
std::vector<std::string> named_spectra();

/// The .spd text of a named spectrum; its head says what it is, where it was published and its range, and its values
/// are those of the source. Throws Error as Spectrum::named().
std::string_view named_spectrum_text(const std::string& name);

/// True for the names of emission spectra, "stdillum-…" (of the CIE) and "illum-…".
bool is_illuminant(const std::string& name);

} // namespace tristim
