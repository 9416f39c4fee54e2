#pragma once

// Rough surfaces, with and without films, and lights for scenes of them.

#include "test_scenes.h"

namespace tristim::test {

struct RoughSurface {
    const char* name;
    bool conductor;
    bool film;
    double alpha_u, alpha_v;
};

inline int add_rough(Scene& scene, const RoughSurface& surface) {
    const int material = surface.conductor
                             ? add_conductor(scene, Spectrum::named("metal-Au-eta"), Spectrum::named("metal-Au-k"))
                             : add_dielectric(scene, Spectrum::constant(1.5));
    Material& m = scene.materials[static_cast<std::size_t>(material)];
    m.alpha_u = surface.alpha_u;
    m.alpha_v = surface.alpha_v;
    if (surface.film)
        m.film.layers = {{300.0, Spectrum::constant(2.2), Spectrum::constant(0.02)}};
    return material;
}

inline Light point_light(const V3d& position, double intensity) {
    Light light;
    light.kind = Light::Kind::Point;
    light.emission = Spectrum::named("stdillum-D65");
    light.position = position;
    light.scale = intensity;
    return light;
}

/// A horizontal square |x|, |y| <= half_side that faces up, u along x and v along y.
inline void add_square_with_uv(Scene& scene, double half_side, int material) {
    add_horizontal_square(scene, half_side, 0.0, true, material);
    scene.shapes.back().mesh.uv = {V2f(0, 0), V2f(1, 0), V2f(1, 1), V2f(0, 1)};
}

constexpr RoughSurface coated_glass{"coated_glass", false, true, 0.5, 0.25};

} // namespace tristim::test
