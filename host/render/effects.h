#pragma once

#include "opencl/program.h"
#include "scene/scene.h"

namespace tristim {

/// The GGX roughness α from which on a surface takes photons and ends camera paths, as a diffuse one does, unless the
/// user says otherwise; smoother surfaces pass camera paths on. By bench/roughness photons cost a tenth more error
/// here, three times as much at half this roughness, and less than passing on from about 0.2; but only photons bring
/// all the light, since passing on misses what comes through glass from a light without area.
constexpr double default_photon_roughness = 0.1;

/// What a scene calls for. Kernels are built with these and hold nothing else.
struct Effects {
    bool dielectric = false;
    bool dispersion = false; ///< a dielectric whose index depends on the wavelength
    bool conductor = false;
    bool film = false;
    bool absorbing_film = false; ///< a film with a layer that absorbs
    bool coated_diffuse = false; ///< a film on a diffuse surface
    bool rough = false;
    double photon_roughness = default_photon_roughness;
    bool rough_photons = false;   ///< a surface that is rough enough to take photons
    bool nearly_specular = false; ///< a rough surface that is not
    bool anisotropic = false;
    bool texture = false;
    bool uv = false; ///< textures or roughness that need the surface's u and v
    bool shading_normals = false;
    bool thin_lens = false;
    bool point_light = false;
    bool spot_light = false;
    bool distant_light = false;
    bool infinite_light = false;
    bool area_light = false;
};

/// Whether the larger of the surface's α reaches the border. A facet that leans by an angle turns refracted light by
/// about |eta - 1| times that, so the lobe of matched indices is narrow however rough the surface is: below 1.5 (or
/// above 1/1.5) a dielectric's α counts for less, in proportion to |eta - 1| where that is least in the spectrum.
bool takes_photons(const Material& material, double photon_roughness);

/// Whether a layer has k > 0.
bool absorbs(const Film& film);

/// Whether camera paths may carry a throughput of its own for every wavelength: COLOURED_EYE of kernels/config.h.
bool has_coloured_eye(const Effects& effects);

/// Whether photons keep the flux of every wavelength: STORE_SPECTRAL_FLUX.
bool stores_spectral_flux(const Effects& effects);

/// Only materials and lights in use count.
Effects derive_effects(const Scene& scene, double photon_roughness = default_photon_roughness);

/// The HAS_… macros of kernels/config.h.
Macros effect_macros(const Effects& effects);

} // namespace tristim
