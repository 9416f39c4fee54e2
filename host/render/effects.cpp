#include "render/effects.h"

#include <algorithm>

namespace tristim {
namespace {

void add_film(const Scene& scene, const Material& material, Effects& effects) {
    const Film& film = material.film;
    effects.film = true;
    effects.coated_diffuse |= material.kind == Material::Kind::Diffuse;
    effects.absorbing_film |= absorbs(film);
    if (film.thickness_texture >= 0) {
        effects.texture = true;
        const Texture& texture = scene.textures[static_cast<std::size_t>(film.thickness_texture)];
        effects.uv |= texture.mapping == Texture::Mapping::Uv;
    }
}

void add_roughness(const Material& material, Effects& effects) {
    effects.rough = true;
    (takes_photons(material, effects.photon_roughness) ? effects.rough_photons : effects.nearly_specular) = true;
    if (material.alpha_u != material.alpha_v)
        effects.anisotropic = effects.uv = true;
}

} // namespace

bool takes_photons(const Material& material, double photon_roughness) {
    double narrowing = 1.0;
    if (material.kind == Material::Kind::Dielectric) {
        for (const double eta : material.eta.bins())
            narrowing = std::min(narrowing, 2.0 * (std::max(eta, 1.0 / eta) - 1.0));
    }
    return narrowing * std::max(material.alpha_u, material.alpha_v) >= photon_roughness;
}

bool absorbs(const Film& film) {
    return std::any_of(film.layers.begin(), film.layers.end(), [](const FilmLayer& layer) {
        return !(layer.k.is_constant() && layer.k(lambda_min_nm) == 0.0);
    });
}

bool has_coloured_eye(const Effects& effects) {
    return effects.conductor || effects.film || effects.rough;
}

bool stores_spectral_flux(const Effects& effects) {
    return effects.dispersion || has_coloured_eye(effects);
}

Effects derive_effects(const Scene& scene, double photon_roughness) {
    Effects effects;
    effects.photon_roughness = photon_roughness;
    for (const Shape& shape : scene.shapes) {
        const Material& material = scene.materials[static_cast<std::size_t>(shape.material)];
        if (material.kind == Material::Kind::Dielectric) {
            effects.dielectric = true;
            effects.dispersion |= !material.eta.is_constant();
        }
        effects.conductor |= material.kind == Material::Kind::Conductor;
        if (!material.film.layers.empty())
            add_film(scene, material, effects);
        if (material.alpha_u > 0.0)
            add_roughness(material, effects);
        effects.shading_normals |= !shape.mesh.normals.empty();
    }
    effects.thin_lens = scene.camera.lens_radius > 0.0;
    for (const Light& light : scene.lights) {
        effects.point_light |= light.kind == Light::Kind::Point;
        effects.spot_light |= light.kind == Light::Kind::Spot;
        effects.distant_light |= light.kind == Light::Kind::Distant;
        effects.infinite_light |= light.kind == Light::Kind::Infinite;
        effects.area_light |= light.kind == Light::Kind::Area;
    }
    return effects;
}

Macros effect_macros(const Effects& effects) {
    const auto flag = [](bool on) { return on ? "1" : "0"; };
    return {{"HAS_FILM", flag(effects.film)},
            {"HAS_ABSORBING_FILM", flag(effects.absorbing_film)},
            {"HAS_COATED_DIFFUSE", flag(effects.coated_diffuse)},
            {"HAS_ROUGH", flag(effects.rough)},
            {"HAS_ROUGH_PHOTONS", flag(effects.rough_photons)},
            {"HAS_NEARLY_SPECULAR", flag(effects.nearly_specular)},
            {"HAS_ANISOTROPIC", flag(effects.anisotropic)},
            {"HAS_TEXTURE", flag(effects.texture)},
            {"HAS_UV", flag(effects.uv)},
            {"HAS_DIELECTRIC", flag(effects.dielectric)},
            {"HAS_DISPERSION", flag(effects.dispersion)},
            {"HAS_CONDUCTOR", flag(effects.conductor)},
            {"HAS_SHADING_NORMALS", flag(effects.shading_normals)},
            {"HAS_THIN_LENS", flag(effects.thin_lens)},
            {"HAS_POINT_LIGHT", flag(effects.point_light)},
            {"HAS_SPOT_LIGHT", flag(effects.spot_light)},
            {"HAS_DISTANT_LIGHT", flag(effects.distant_light)},
            {"HAS_INFINITE_LIGHT", flag(effects.infinite_light)},
            {"HAS_AREA_LIGHT", flag(effects.area_light)}};
}

} // namespace tristim
