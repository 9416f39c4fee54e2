// What a film on a diffuse body reflects of the diffuse light that comes from below.
#ifndef TRISTIM_INTERNAL_REFLECTANCE_H
#define TRISTIM_INTERNAL_REFLECTANCE_H

#include "thin_film.h"

#define QUADRATURE_POINTS 48  // enough for films up to 2 µm
#define MOST_QUADRATURE_POINTS 4096
#define THINNEST_TABULATED 16.0f  // nm

// The points that a film's fringes need, from QUADRATURE_POINTS to `most`: the thicker it is, the narrower they are. Weakly absorbing
// films lose what they guide at angles that are narrower still.
int quadrature_points(const ThinFilm* film, int most) {
    float thickness = film->first_thickness;
    for (int i = 1; i < film->count; ++i)
        thickness += film->layers[i].thickness;
    const float per_nm = (HAS_ABSORBING_FILM ? 8.0f : 1.0f) * QUADRATURE_POINTS / 2000.0f;
    return (int)clamp(thickness * per_nm, (float)QUADRATURE_POINTS, (float)most);
}

// ∫ R(μ) 2μ dμ over the cosines μ in [0, 1] in the body, whose index n is at least 1, for a block of wavelengths. The angles of which
// something is transmitted are taken in steps of the cosine outside, with n² μ dμ = μ_o dμ_o, since R runs smoothly in μ_o; the
// totally reflected ones are apart. Midpoint rule in x with μ_o = x³(10 - 15x + 6x²), whose first two derivatives vanish at both
// ends, so that its error falls with the fourth power of the step (Euler and Maclaurin) once there are some points to a fringe.
floatv internal_reflectance(const global float* pass_table, int block, const ThinFilm* film, floatv n, int points) {
    const floatv total = 1.0f - 1.0f / (n * n);  // μ² of the critical angle
    floatv transmissible = 0.0f, absorbed = 0.0f;
    for (int i = 0; i < points; ++i) {
        const float x = ((float)i + 0.5f) / (float)points;
        const float cosine = x * x * x * (10.0f - x * (15.0f - 6.0f * x));
        const float slope = 30.0f * x * x * (1.0f - x) * (1.0f - x);
        const float weight = slope * cosine / (float)points;
        const floatv outside = 1.0f - (1.0f - cosine) * (1.0f + cosine) / (n * n);
        const FilmOptics o = film_optics(pass_table, block, film, false, sqrt(outside), (floatv)(1.0f), n, (floatv)(0.0f));
        transmissible += weight * (o.reflected_s + o.reflected_p);
#if HAS_ABSORBING_FILM
        const FilmOptics t = film_optics(pass_table, block, film, false, cosine * sqrt(total), (floatv)(1.0f), n, (floatv)(0.0f));
        absorbed += weight * (2.0f - t.reflected_s - t.reflected_p);
#endif
    }
    return transmissible / (n * n) + total * (1.0f - absorbed);
}

// The same from the rows that film_tables.cl has filled for the material, whose film absorbs nothing: between them the cubic through the four next ones
// (Lagrange). In steps of 4 nm (host/render/flat_scene.cpp) the phase turns by at most 0.3 radians, and the cubic is right to
// 4e-4 of what the film makes F swing by.
floatv tabulated_internal_reflectance(const global float* pass_table, int block, const global SurfaceMaterial* material,
                                      float thickness) {
    const global float* row = spectrum_row(pass_table, material->internal_reflectance);
    if (material->internal_rows == 1)
        return vloadv(block, row);
    const float x = (thickness - material->internal_thickness) / material->internal_step;
    const int i = clamp((int)x, 1, material->internal_rows - 3);
    const float t = x - (float)i;
    row += (i - 1) * W_PADDED;
    return vloadv(block, row) * (-t * (t - 1.0f) * (t - 2.0f) / 6.0f) +
           vloadv(block, row + W_PADDED) * ((t + 1.0f) * (t - 1.0f) * (t - 2.0f) / 2.0f) +
           vloadv(block, row + 2 * W_PADDED) * (-(t + 1.0f) * t * (t - 2.0f) / 2.0f) +
           vloadv(block, row + 3 * W_PADDED) * ((t + 1.0f) * t * (t - 1.0f) / 6.0f);
}

// Whether the rows tell of a thickness. They do not where a texture goes on beyond its values, nor for the thinnest films, whose
// reflectance at grazing angles grows too quickly with the thickness for a cubic.
bool is_tabulated(const global SurfaceMaterial* material, float thickness) {
    const float begin = max(material->internal_thickness, THINNEST_TABULATED);
    const float end = material->internal_thickness + (float)(material->internal_rows - 1) * material->internal_step;
    return material->internal_rows == 1 || (material->internal_rows > 1 && thickness >= begin && thickness <= end);
}

#endif
