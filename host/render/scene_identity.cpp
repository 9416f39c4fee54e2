#include "render/scene_identity.h"

#include "base/hash.h"

namespace tristim {
namespace {

/// What follows from the scene and from the part of the image that is rendered is none of the camera's.
SceneConstants camera_alone(SceneConstants constants) {
    constants.light_count = constants.infinite_light = 0;
    constants.centre_x = constants.centre_y = constants.centre_z = constants.radius = 0.0F;
    constants.region_x = constants.region_y = constants.region_width = constants.region_height = 0;
    constants.image_width = constants.image_height = 0;
    return constants;
}

} // namespace

SceneIdentity scene_identity(const Scene& scene, const RenderOptions& options) {
    const FlatScene flat = flatten_scene(scene, derive_effects(scene), options.width, options.height, options.region);
    Hash content;
    content.add(flat.triangles);
    content.add(flat.attributes);
    content.add(flat.materials);
    content.add(flat.film_layers);
    content.add(flat.textures);
    content.add(flat.texels);
    content.add(flat.lights);
    content.add(flat.spectra.values(parse_method("spectral:400")));
    content.add(flat.spectra.smooth());
    Hash camera;
    camera.add(camera_alone(flat.constants));
    return {content.hexadecimal(), camera.hexadecimal(), options.width,
            options.height,        options.region,       options.max_depth};
}

} // namespace tristim
