#pragma once

#include "base/region.h"
#include "bvh/bvh.h"
#include "render/effects.h"
#include "render/spectrum_table.h"
#include "scene/scene.h"
#include "shared_types.h"

#include <vector>

namespace tristim {

/// A scene in the arrays that the kernels read.
struct FlatScene {
    V3d origin{0.0}; ///< where all coordinates here count from, in the world: see coordinate_origin
    SceneConstants constants{};
    TriangleSoup soup;               ///< for build_bvh
    std::vector<Triangle> triangles; ///< same order
    std::vector<float> attributes;   ///< of the triangles' vertices, see Triangle::attributes
    std::vector<SurfaceMaterial> materials;
    std::vector<SceneFilmLayer> film_layers;
    std::vector<SceneTexture> textures;
    std::vector<float> texels;
    std::vector<SceneLight> lights; ///< an area light becomes one for each of its triangles
    std::vector<float> light_cdf;   ///< lights.size() + 1 values, by power
    SpectrumTable spectra;
    WavelengthBins emission{}; ///< power of all lights in each bin of 1 nm, up to a factor
    int film_table_rows = 0;   ///< of the pass table behind the spectra, which film_tables.cl fills
};

/// Flattens a scene for an image of the given size, of which `region` is rendered. Throws Error if the scene emits no
/// light within the visible range.
FlatScene flatten_scene(const Scene& scene, const Effects& effects, int width, int height, const Region& region);

/// A triangle's geometry as the kernels read it, of no light and without attributes.
Triangle flat_triangle(const V3f& v0, const V3f& v1, const V3f& v2);

/// The geometry of an area light that is a triangle; of radiance 1 and chosen with certainty.
SceneLight flat_area_light(const V3f& v0, const V3f& v1, const V3f& v2);

} // namespace tristim
