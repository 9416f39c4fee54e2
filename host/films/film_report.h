#pragma once

#include "films/film_colour.h"
#include "films/film_stack.h"
#include "plot/plot.h"

#include <string>
#include <vector>

namespace tristim {

/// What a stack does to light of one wavelength and angle.
struct FilmSpectrumRow {
    double wavelength_nm = 0.0;
    double angle_deg = 0.0;
    FilmResponse response;
};

/// The colour of a stack at an angle and, of a sweep, a thickness.
struct FilmColourRow {
    double angle_deg = 0.0;
    double thickness_nm = 0.0;
    FilmColour colour;
};

/// What `tristim film` found out. A report without a sweep has spectrum rows, angle by angle, and one colour for each
/// angle; one with a sweep has colours only, angle by angle.
struct FilmReport {
    FilmStack stack;
    std::string illuminant;
    Xyz white{};
    std::string device;
    std::string math;
    std::vector<double> wavelengths_nm, angles_deg;
    std::optional<std::size_t> swept_layer; ///< from 0
    std::vector<double> thicknesses_nm;     ///< of the swept layer
    std::vector<FilmSpectrumRow> spectrum;
    std::vector<FilmColourRow> colours;

    /// The stack in words; a swept layer with its range of thicknesses.
    std::string title() const;
};

/// Spectrum rows as wavelength_nm,angle_deg,R_s,R_p,R,T_s,T_p,T, or the sweep's colours.
std::string film_csv(const FilmReport& report);

/// Everything, as a JSON object.
std::string film_json(const FilmReport& report);

/// For people: some of the wavelengths, and the colours.
std::string film_table(const FilmReport& report);

/// R and T against wavelength, or against the angle if there is one wavelength only; of a sweep, which must have one
/// angle, X, Y and Z of the reflected light against thickness above a strip of its colours.
Plot film_plot(const FilmReport& report);

} // namespace tristim
