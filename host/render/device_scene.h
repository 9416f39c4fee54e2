#pragma once

#include "render/options.h"
#include "render/scene_buffers.h"

#include <memory>
#include <string>
#include <vector>

namespace tristim {

/// A scene on a device as any number of renderers use it at once, whatever their methods: what was derived from it, its
/// tree and its buffers. Renderers only read it.
class DeviceScene {
  public:
    /// For renders of these options' resolution, region, photon roughness and effects; the other options do not matter.
    /// Throws Error if these cannot be rendered, the scene emits no visible light or the device has too little memory.
    DeviceScene(const Scene& scene, const RenderOptions& options, const Device& device);

    /// What of a renderer with these options on this device keeps it from using this: "resolution", "region", "photon
    /// roughness", "choice of effects" or "device"; empty if nothing does.
    std::string mismatch(const RenderOptions& options, const Device& device) const;

    /// With RenderOptions::more_effects.
    const Effects& effects() const { return effects_; }
    const SceneBuffers& buffers() const { return buffers_; }

    /// The flattened scene without triangles, their attributes and texels, which are large and on the device.
    const FlatScene& flat() const { return flat_; }

  private:
    ::cl::Context context_;
    int width_;
    int height_;
    Region region_;
    Effects more_effects_;
    Effects effects_;
    FlatScene flat_;
    SceneBuffers buffers_;
};

/// The device scenes of one scene, each made when a render first asks for it.
class DeviceScenes {
  public:
    /// Keeps a reference to the scene.
    explicit DeviceScenes(const Scene& scene) : scene_(scene) {}

    /// One that a renderer with these options on this device can use. Throws Error as DeviceScene does.
    std::shared_ptr<const DeviceScene> get(const RenderOptions& options, const Device& device);

    const Scene& scene() const { return scene_; }

  private:
    const Scene& scene_;
    std::vector<std::shared_ptr<const DeviceScene>> made_;
};

} // namespace tristim
