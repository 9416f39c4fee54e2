// What a path carries, and what surfaces do to it. The file that includes this defines PATH_SPECTRUM: 1 if paths carry a
// value for each wavelength, 0 if one value serves all of them until a dispersive surface makes the path keep one slot.
#ifndef TRISTIM_BSDF_H
#define TRISTIM_BSDF_H

#include "path_weight.h"
#include "specular.h"
#if HAS_FILM || HAS_ROUGH
#include "interface.h"
#endif
#if HAS_COATED_DIFFUSE
#include "coated_diffuse.h"
#endif

// Whether a surface scatters by chance into directions that light can be sampled for, and yet passes camera paths on.
bool is_nearly_specular(const global SurfaceMaterial* material) {
    return HAS_NEARLY_SPECULAR && is_rough(material) && !material->takes_photons;
}

// Whether a rough surface takes photons.
bool takes_photons(const global SurfaceMaterial* material) {
    return HAS_NEARLY_SPECULAR ? HAS_ROUGH_PHOTONS && material->takes_photons : HAS_ROUGH_PHOTONS;
}

// A path that meets a dispersive surface with every wavelength goes on with the one of `slot`.
void meet_dispersion(const global SurfaceMaterial* material, int slot, PathWeight* weight) {
#if HAS_DISPERSION
    if (material->dispersive && weight->slot < 0)
        keep_slot(weight, slot);
#endif
}

// Scatters a path at a dielectric or a conductor; u are random numbers, of which u.x chooses between reflection and refraction.
// `radiance` says that the path runs from the camera, `slot` is what it keeps should the surface be dispersive. Returns
// whether the path goes on. *pdf [1/sr] becomes that of the new direction, 0 for a smooth surface, which has none. Inlined, as both
// passes' meet_diffuse, it makes a pass a hundredth shorter on PoCL.
__attribute__((always_inline))
bool scatter(const Scene* scene, const global SurfaceMaterial* material, const Interaction* it, float3* direction, float3 u,
             int slot, bool radiance, PathWeight* weight, float* pdf) {
    *pdf = 0.0f;
    meet_dispersion(material, slot, weight);
#if HAS_FILM || HAS_ROUGH
    if (film_layers_on(material) > 0 || is_rough(material))
        return scatter_interface(scene, material, it, direction, u, radiance, weight, pdf);
#endif
#if HAS_DIELECTRIC
    if (is_dielectric(material))
        *direction = scatter_dielectric(scene, material, it, *direction, u.x, radiance, weight);
#endif
#if HAS_CONDUCTOR
    if (is_conductor(material))
        *direction = scatter_conductor(scene, material, it, *direction, weight);
#endif
    return true;
}

#endif
