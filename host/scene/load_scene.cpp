#include "scene/scene.h"

#include "scene/scene_builder.h"
#include "scene/scene_parser.h"

namespace tristim {

Scene load_scene(const std::string& path) {
    SceneBuilder builder(path);
    SceneParser parser(path, builder);
    parser.run();
    return builder.finish();
}

} // namespace tristim
