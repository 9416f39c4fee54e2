#include "render/effects.h"

#include "base/error.h"
#include "base/split.h"

#include <algorithm>
#include <set>

namespace tristim {
namespace {

using E = Effects;

constexpr EffectKind table[] = {
    {"dielectric", "HAS_DIELECTRIC", &E::dielectric, "glass and its like, which reflect and refract"},
    {"dispersion", "HAS_DISPERSION", &E::dispersion, "refraction that depends on the wavelength", {&E::dielectric}},
    {"conductor", "HAS_CONDUCTOR", &E::conductor, "metals"},
    {"film", "HAS_FILM", &E::film, "thin films, which interfere"},
    {"absorbing-film", "HAS_ABSORBING_FILM", &E::absorbing_film, "films with a layer that absorbs", {&E::film}},
    {"coated-diffuse", "HAS_COATED_DIFFUSE", &E::coated_diffuse, "films on diffuse surfaces", {&E::film}},
    {"rough", "HAS_ROUGH", &E::rough, "rough glass or metal"},
    {"rough-photons", "HAS_ROUGH_PHOTONS", &E::rough_photons, "surfaces rough enough to take photons", {&E::rough}},
    {"nearly-specular",
     "HAS_NEARLY_SPECULAR",
     &E::nearly_specular,
     "rough surfaces that pass camera paths on",
     {&E::rough}},
    {"anisotropic", "HAS_ANISOTROPIC", &E::anisotropic, "roughness that differs along u and v", {&E::rough, &E::uv}},
    {"texture", "HAS_TEXTURE", &E::texture, "textures of a film's thickness", {&E::film}},
    {"uv", "HAS_UV", &E::uv, "surface coordinates u and v"},
    {"shading-normals", "HAS_SHADING_NORMALS", &E::shading_normals, "normals at the vertices of meshes"},
    {"thin-lens", "HAS_THIN_LENS", &E::thin_lens, "a camera with a lens, which blurs what is out of focus"},
    {"point-light", "HAS_POINT_LIGHT", &E::point_light, "point lights"},
    {"spot-light", "HAS_SPOT_LIGHT", &E::spot_light, "spot lights"},
    {"distant-light", "HAS_DISTANT_LIGHT", &E::distant_light, "distant lights, such as the sun"},
    {"infinite-light", "HAS_INFINITE_LIGHT", &E::infinite_light, "light from all around, such as the sky"},
    {"area-light", "HAS_AREA_LIGHT", &E::area_light, "surfaces that emit"},
};

/// Finds out what a scene calls for.
class Reasons {
  public:
    Reasons(const Scene& scene, double photon_roughness) : scene_(scene), photon_roughness_(photon_roughness) {
        std::vector<bool> seen(scene.materials.size(), false);
        for (const Shape& shape : scene.shapes) {
            const auto material = static_cast<std::size_t>(shape.material);
            if (!seen[material])
                add_material(scene.materials[material]);
            seen[material] = true;
            if (!shape.mesh.normals.empty())
                add(&E::shading_normals, "mesh with normals", shape.where);
        }
        if (scene.camera.lens_radius > 0.0)
            add(&E::thin_lens, fmt::format("camera: lens radius {:g}", scene.camera.lens_radius), scene.camera.where);
        for (const Light& light : scene.lights)
            add_light(light);
    }

    std::vector<EffectReason> all;

  private:
    /// An area light becomes one for each of its patches, all of the same line.
    void add(EffectFlag effect, const std::string& what, const SourceLocation& where) {
        const auto* const kind = std::find_if(std::begin(table), std::end(table),
                                              [&](const EffectKind& other) { return other.flag == effect; });
        if (known_.insert(fmt::format("{}: {} {}", kind->name, what, where.text())).second)
            all.push_back({effect, what, where});
    }

    void add_material(const Material& material) {
        const std::string name = material.name.empty() ? "material" : fmt::format("material \"{}\"", material.name);
        if (material.kind == Material::Kind::Dielectric) {
            add(&E::dielectric, name, material.where);
            if (!material.eta.is_constant())
                add(&E::dispersion, name + ": its eta depends on the wavelength", material.where);
        }
        if (material.kind == Material::Kind::Conductor)
            add(&E::conductor, name, material.where);
        if (!material.film.layers.empty())
            add_film(material, name);
        if (material.alpha_u > 0.0)
            add_roughness(material, name);
    }

    void add_film(const Material& material, const std::string& name) {
        const Film& film = material.film;
        add(&E::film,
            fmt::format("{}: a film of {} layer{}", name, film.layers.size(), film.layers.size() == 1 ? "" : "s"),
            material.where);
        if (material.kind == Material::Kind::Diffuse)
            add(&E::coated_diffuse, name + ": a film on a diffuse surface", material.where);
        if (absorbs(film))
            add(&E::absorbing_film, name + ": a layer of its film has k > 0", material.where);
        if (film.thickness_texture < 0)
            return;
        const Texture& texture = scene_.textures[static_cast<std::size_t>(film.thickness_texture)];
        const std::string texture_name = texture.name.empty() ? "texture" : fmt::format("texture \"{}\"", texture.name);
        add(&E::texture, texture_name, texture.where);
        if (texture.mapping == Texture::Mapping::Uv)
            add(&E::uv, texture_name + ": mapped by u and v", texture.where);
    }

    void add_roughness(const Material& material, const std::string& name) {
        const std::string alpha = material.alpha_u == material.alpha_v
                                      ? fmt::format("{:.3g}", material.alpha_u)
                                      : fmt::format("{:.3g} and {:.3g}", material.alpha_u, material.alpha_v);
        add(&E::rough, fmt::format("{}: alpha {}", name, alpha), material.where);
        if (takes_photons(material, photon_roughness_))
            add(&E::rough_photons, fmt::format("{}: alpha {} reaches --photon-roughness", name, alpha), material.where);
        else
            add(&E::nearly_specular, fmt::format("{}: alpha {} is below --photon-roughness", name, alpha),
                material.where);
        if (material.alpha_u != material.alpha_v) {
            for (const EffectFlag effect : {&E::anisotropic, &E::uv})
                add(effect, fmt::format("{}: alpha {} along u and v", name, alpha), material.where);
        }
    }

    void add_light(const Light& light) {
        switch (light.kind) {
        case Light::Kind::Point:
            return add(&E::point_light, "point light", light.where);
        case Light::Kind::Spot:
            return add(&E::spot_light, "spot light", light.where);
        case Light::Kind::Distant:
            return add(&E::distant_light, "distant light", light.where);
        case Light::Kind::Infinite:
            return add(&E::infinite_light, "infinite light", light.where);
        case Light::Kind::Area:
            return add(&E::area_light, "area light", light.where);
        }
    }

    const Scene& scene_;
    double photon_roughness_;
    std::set<std::string> known_;
};

/// Turns on what the effects that are on need. A row's needs may have needs of their own in any row.
void add_needs(Effects& effects) {
    for (Effects before; before != effects;) {
        before = effects;
        for (const EffectKind& kind : table) {
            for (const EffectFlag need : kind.needs) {
                if (need != nullptr && effects.*kind.flag)
                    effects.*need = true;
            }
        }
    }
}

} // namespace

std::span<const EffectKind> effect_table() {
    return table;
}

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

std::vector<EffectReason> effect_reasons(const Scene& scene, double photon_roughness) {
    return Reasons(scene, photon_roughness).all;
}

Effects derive_effects(const Scene& scene, double photon_roughness) {
    Effects effects;
    effects.photon_roughness = photon_roughness;
    for (const EffectReason& reason : effect_reasons(scene, photon_roughness))
        effects.*reason.effect = true;
    return effects;
}

Effects parse_effects(const std::string& names) {
    Effects effects;
    for (const std::string& name : split(names, ',')) {
        const auto found =
            std::find_if(std::begin(table), std::end(table), [&](const EffectKind& kind) { return kind.name == name; });
        if (found != std::end(table)) {
            effects.*found->flag = true;
        } else if (name == "all") {
            for (const EffectKind& kind : table)
                effects.*kind.flag = true;
        } else {
            std::vector<std::string> known;
            for (const EffectKind& kind : table)
                known.emplace_back(kind.name);
            fail("unknown effect '{}': expected all, or of these, separated by commas: {}", name,
                 fmt::join(known, ", "));
        }
    }
    add_needs(effects);
    return effects;
}

Effects united(const Effects& effects, const Effects& more) {
    Effects both = effects;
    for (const EffectKind& kind : table)
        both.*kind.flag |= more.*kind.flag;
    return both;
}

Macros effect_macros(const Effects& effects) {
    Macros macros;
    for (const EffectKind& kind : table)
        macros.emplace_back(kind.macro, effects.*kind.flag ? "1" : "0");
    return macros;
}

} // namespace tristim
