#pragma once

#include "films/film_evaluator.h"
#include "spectra/colour.h"

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tristim {

/// XYZ of what a film makes of a light, the light's own Y = 1.
struct FilmColour {
    Xyz reflected{};
    Xyz transmitted{};
};

/// The colours of films under a light: XYZ = ∫ L R f dλ / ∫ L ȳ dλ over 380–780 nm.
///
/// Fringes of thick films and lines of lamps may be narrower than 1 nm, so each nanometre is cut into 1, 2, 4, … parts,
/// at least four to a fringe. A part's light stands at its mean wavelength: lines keep both energy and place. Parts are
/// halved until no X, Y or Z moves by more than 1e-5.
class FilmColours {
  public:
    /// Throws Error if the stack's indices do not cover 380–780 nm. The evaluator must outlive this.
    FilmColours(const FilmEvaluator& evaluator, const Spectrum& light);

    /// XYZ of the light itself; Y = 1.
    Xyz white() const;

    /// The stack as it is. Throws Error if halving does not converge.
    FilmColour colour(double angle_deg);

    /// With each thickness, in nm, of layer `layer` (from 0).
    std::vector<FilmColour> colours(double angle_deg, std::size_t layer, const std::vector<double>& thicknesses);

  private:
    /// A quadrature of XYZ.
    struct Nodes {
        std::vector<double> lambda_nm;
        std::vector<Xyz> weights;
    };
    const Nodes& nodes(int parts_per_nm);
    std::vector<FilmColour> sums(int parts_per_nm, double angle_deg, std::optional<std::size_t> layer,
                                 const std::vector<double>& thicknesses);
    std::vector<FilmColour> converged(double angle_deg, std::optional<std::size_t> layer,
                                      const std::vector<double>& thicknesses);
    double fringes_per_nm(std::optional<std::size_t> layer, double thickness) const;

    const FilmEvaluator& evaluator_;
    Spectrum light_;
    std::map<int, Nodes> nodes_; ///< by parts per nm
};

/// A colour for a display.
struct DisplayColour {
    std::array<int, 3> rgb{}; ///< 8-bit sRGB
    bool clipped = false;     ///< a channel lies outside 0…255, by more than rounding
    std::string hex() const;  ///< "#rrggbb"
};

/// sRGB (IEC 61966-2-1) of XYZ whose Y = 1 is the display's white; no chromatic adaptation. Channels out of range are
/// clipped.
DisplayColour display_colour(const Xyz& xyz);

/// Chromaticity x, y; none for black.
std::optional<std::array<double, 2>> chromaticity(const Xyz& xyz);

} // namespace tristim
