#include "scene/scene.h"

#include "scene/scene_builder.h"
#include "scene/scene_parser.h"

namespace tristim {

Scene load_scene(const std::string& path, std::optional<RgbUpsampling> rgb_upsampling) {
    SceneBuilder builder(path, rgb_upsampling);
    SceneParser parser(path, builder);
    parser.run();
    return builder.finish();
}

} // namespace tristim
