#pragma once

// Surfaces with films, and their normal, that scatter and evaluate_rough are tested with.

#include "interface_kernel.h"

#include <vector>

namespace tristim::kernel_test {

/// kernels/thin_film.h against its oracle, for films up to 2 µm.
constexpr double film_error = 5e-6;

inline const Vec3 normal = normalized({0.48, -0.6, 0.64});

inline std::vector<CoatedSurface> smooth_surfaces() {
    const FilmOfTest oxide{300.0, {1.47F, 1.465F, 1.46F, 1.458F, 1.456F, 1.455F}, {}};
    const FilmOfTest titania{110.0, {2.9F, 2.75F, 2.65F, 2.6F, 2.55F, 2.5F}, {}};
    const FilmOfTest absorbing{40.0, {1.2F, 1.0F, 0.9F, 0.6F, 0.3F, 0.2F}, {1.8F, 2.0F, 2.2F, 2.6F, 3.1F, 3.5F}};
    const PerWavelength glass{1.5F, 1.5F, 1.5F, 1.5F, 1.5F, 1.5F};
    const PerWavelength flint{1.68F, 1.66F, 1.64F, 1.63F, 1.62F, 1.61F};
    const PerWavelength one{1.0F, 1.0F, 1.0F, 1.0F, 1.0F, 1.0F};
    const PerWavelength metal_n{1.4F, 1.3F, 1.0F, 0.6F, 0.3F, 0.2F}, metal_k{1.9F, 1.9F, 2.0F, 2.2F, 2.8F, 3.3F};
    return {{"oxide on glass", MATERIAL_DIELECTRIC, false, glass, {}, {oxide}, {}},
            {"soap bubble", MATERIAL_DIELECTRIC, false, one, {}, {{420.0, flint, {}}}, {}},
            {"absorbing film on glass", MATERIAL_DIELECTRIC, false, glass, {}, {oxide, absorbing}, {}},
            {"three layers on flint", MATERIAL_DIELECTRIC, true, flint, {}, {oxide, titania, oxide}, {}},
            {"oxide on metal", MATERIAL_CONDUCTOR, false, metal_n, metal_k, {oxide}, {}},
            {"absorbing film on metal", MATERIAL_CONDUCTOR, false, metal_n, metal_k, {titania, absorbing}, {}}};
}

} // namespace tristim::kernel_test
