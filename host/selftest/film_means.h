#pragma once

// What a path takes from films as sums: over the wavelengths of many passes, and over the directions inside a diffuse
// body.

#include "selftest/film_points.h"

namespace tristim::selftest {

/// The mean reflectance over the visible wavelengths of films whose fringes may be narrower than a nanometre, from one
/// wavelength in each of many strata: how many standard errors it is off, to each of which the kernel's own error may
/// add 1e-6. By thickness.
Measurement mean_over_wavelengths(FilmKernels& kernels, const Setting& setting);

/// Films for the reflectance of coated bodies for diffuse light from inside, clear or absorbing, by thickness.
struct InternalFilms {
    double thinnest = 0.0, thickest = 0.0; ///< nm
    bool absorbing = false;
    int most_quadrature_points = 0; ///< that the kernel may take
};

/// That reflectance against a fine quadrature.
Measurement internal_reflectance(FilmKernels& kernels, const Setting& setting, const InternalFilms& films);

} // namespace tristim::selftest
