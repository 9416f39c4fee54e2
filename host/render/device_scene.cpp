#include "render/device_scene.h"

#include <algorithm>

namespace tristim {

DeviceScene::DeviceScene(const Scene& scene, const RenderOptions& options, const Device& device)
    : context_(device.context), width_(options.width), height_(options.height), region_(options.region),
      more_effects_(options.more_effects) {
    check_options(options);
    effects_ = united(derive_effects(scene, options.photon_roughness), options.more_effects);
    flat_ = flatten_scene(scene, effects_, width_, height_, region_);
    buffers_ = SceneBuffers(device, flat_);
    flat_.soup = {};
    flat_.triangles = {};
    flat_.attributes = {};
    flat_.texels = {};
}

std::string DeviceScene::mismatch(const RenderOptions& options, const Device& device) const {
    if (options.width != width_ || options.height != height_)
        return "resolution";
    if (options.region != region_)
        return "region";
    if (options.photon_roughness != effects_.photon_roughness)
        return "photon roughness";
    if (options.more_effects != more_effects_)
        return "choice of effects";
    return device.context() == context_() ? "" : "device";
}

std::shared_ptr<const DeviceScene> DeviceScenes::get(const RenderOptions& options, const Device& device) {
    const auto made = std::find_if(made_.begin(), made_.end(),
                                   [&](const auto& scene) { return scene->mismatch(options, device).empty(); });
    if (made != made_.end())
        return *made;
    return made_.emplace_back(std::make_shared<const DeviceScene>(scene_, options, device));
}

} // namespace tristim
