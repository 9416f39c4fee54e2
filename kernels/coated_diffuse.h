// A thin film on a diffuse body: what the film transmits is scattered below it, reflected back and forth between film and body,
// and leaves through the film (Saunderson 1942, "Calculation of the Color of Pigmented Plastics"; with Snell's and Fresnel's laws
// on both ways Wolff 1994, "Diffuse-Reflectance Model for Smooth Dielectric Surfaces"). With the body's albedo ρ and index n,
// the film's transmittance T(θ) from outside (that of a passive film is the same from inside) and its reflectance F for
// diffuse light from inside, the diffuse part of the BRDF is
//     T(θ_i) T(θ_o) ρ / (π n² (1 - ρ F)),
// beside the film's specular reflection. Where nothing is absorbed the mean of T(θ) over a diffuse light is n² (1 - F), so that a
// white body reflects everything.
#ifndef TRISTIM_COATED_DIFFUSE_H
#define TRISTIM_COATED_DIFFUSE_H

#include "interface.h"
#include "internal_reflectance.h"

// ρ / (n² (1 - ρ F)) where the film's first layer is of this thickness; blocks as in interface_optics.
Spectrum body_reflectance(const Scene* scene, const global SurfaceMaterial* material, float thickness, int slot) {
    const global float* rho = spectrum_row(scene->pass_table, material->reflectance);
    const global float* eta = spectrum_row(scene->pass_table, material->eta);
    const int first = first_block(slot), last = last_block(slot);
    Spectrum body;
    for (int b = first; b < last; ++b) {
        const floatv n = vloadv(b, eta), r = vloadv(b, rho);
#if HAS_TEXTURE
        const ThinFilm film = {scene->film_layers + material->film, material->film_layers, thickness};
        const floatv f = is_tabulated(material, thickness)
                             ? tabulated_internal_reflectance(scene->pass_table, b, material, thickness)
                             : internal_reflectance(scene->pass_table, b, &film, n, QUADRATURE_POINTS);
#else
        const floatv f = tabulated_internal_reflectance(scene->pass_table, b, material, thickness);
#endif
        body.block[b] = r / (n * n * (1.0f - r * f));
    }
    return body;
}

// The film's transmittance from outside, either way.
Spectrum coat_transmittance(const Scene* scene, const global SurfaceMaterial* material, float thickness, float cosine, int slot) {
    return interface_optics(scene, material, thickness, true, cosine, slot).transmitted;
}

#endif
