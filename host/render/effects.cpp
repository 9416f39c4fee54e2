#include "render/effects.h"

namespace tristim {

Effects derive_effects(const Scene& scene) {
    Effects effects;
    for (const Shape& shape : scene.shapes) {
        const Material& material = scene.materials[static_cast<std::size_t>(shape.material)];
        if (material.kind == Material::Kind::Dielectric) {
            effects.dielectric = true;
            effects.dispersion |= !material.eta.is_constant();
        }
        effects.conductor |= material.kind == Material::Kind::Conductor;
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
    return {
        {"HAS_DIELECTRIC", flag(effects.dielectric)},         {"HAS_DISPERSION", flag(effects.dispersion)},
        {"HAS_CONDUCTOR", flag(effects.conductor)},           {"HAS_SHADING_NORMALS", flag(effects.shading_normals)},
        {"HAS_THIN_LENS", flag(effects.thin_lens)},           {"HAS_POINT_LIGHT", flag(effects.point_light)},
        {"HAS_SPOT_LIGHT", flag(effects.spot_light)},         {"HAS_DISTANT_LIGHT", flag(effects.distant_light)},
        {"HAS_INFINITE_LIGHT", flag(effects.infinite_light)}, {"HAS_AREA_LIGHT", flag(effects.area_light)}};
}

} // namespace tristim
