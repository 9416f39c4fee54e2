#pragma once

#include "opencl/program.h"
#include "scene/scene.h"

#include <array>
#include <span>
#include <string>
#include <vector>

namespace tristim {

/// The GGX roughness α from which on a surface takes photons and ends camera paths, as a diffuse one does, unless the
/// user says otherwise; smoother surfaces pass camera paths on. By bench/roughness photons cost a tenth more error
/// here, three times as much at half this roughness, and less than passing on from about 0.2; but only photons bring
/// all the light, since passing on misses what comes through glass from a light without area.
constexpr double default_photon_roughness = 0.1;

/// What a scene calls for. Kernels are built with these and hold nothing else. What each is stands in effect_table().
struct Effects {
    bool dielectric = false;
    bool dispersion = false;
    bool conductor = false;
    bool film = false;
    bool absorbing_film = false;
    bool coated_diffuse = false;
    bool rough = false;
    bool rough_photons = false;
    bool nearly_specular = false;
    bool anisotropic = false;
    bool texture = false;
    bool uv = false;
    bool shading_normals = false;
    bool thin_lens = false;
    bool point_light = false;
    bool spot_light = false;
    bool distant_light = false;
    bool infinite_light = false;
    bool area_light = false;
    double photon_roughness = default_photon_roughness; ///< what tells rough_photons from nearly_specular

    bool operator==(const Effects&) const = default;
};

/// Which flag of Effects.
using EffectFlag = bool Effects::*;

/// A row of the table of effects.
struct EffectKind {
    const char* name;                     ///< as --effects takes it
    const char* macro;                    ///< of kernels/config.h
    EffectFlag flag;                      ///< whether it is on
    const char* meaning;                  ///< one line for people
    std::array<EffectFlag, 2> needs = {}; ///< what it cannot be without, null where there is no more
};
std::span<const EffectKind> effect_table();

/// Why an effect is on.
struct EffectReason {
    EffectFlag effect;
    std::string what;     ///< "material \"glass\": …", "spot light", "camera: …"
    SourceLocation where; ///< in the scene file; none for scenes that were not read from one
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

/// Everything in the scene that calls for an effect, each once, in the order of the scene. Only materials, textures and
/// lights in use count.
std::vector<EffectReason> effect_reasons(const Scene& scene, double photon_roughness = default_photon_roughness);

/// The effects that effect_reasons() tells of.
Effects derive_effects(const Scene& scene, double photon_roughness = default_photon_roughness);

/// What --effects takes: names separated by commas, or "all"; with them what they need. Throws Error with the names
/// that there are for any other.
Effects parse_effects(const std::string& names);

/// `effects` with those that are on in `more`.
Effects united(const Effects& effects, const Effects& more);

/// The HAS_… macros of kernels/config.h.
Macros effect_macros(const Effects& effects);

} // namespace tristim
