#pragma once

#include "bvh/bvh.h"
#include "opencl/buffer.h"
#include "render/flat_scene.h"
#include "render/ray_recorder.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace tristim {

/// A scene on a device: the buffers behind SCENE_PARAMETERS of kernels/scene.h, which kernels only read.
class SceneBuffers {
  public:
    SceneBuffers() = default;

    /// Builds the tree and uploads everything.
    SceneBuffers(const Device& device, const FlatScene& scene);

    /// Sets the kernel's first arguments, the scene and where a render keeps its spectra and rays, and returns the
    /// index of the next one.
    cl_uint bind(::cl::Kernel& kernel, const Buffer<float>& pass_table, const RayRecorder& recorder) const;

    const Bvh& bvh() const { return bvh_; }
    double bvh_seconds() const { return bvh_seconds_; }
    const Buffer<SceneConstants>& constants() const { return constants_; }
    const Buffer<SurfaceMaterial>& materials() const { return materials_; }
    const Buffer<SceneFilmLayer>& film_layers() const { return film_layers_; }

    std::vector<std::pair<std::string, std::uint64_t>> sizes() const;

  private:
    Bvh bvh_;
    double bvh_seconds_ = 0.0;
    Buffer<SceneConstants> constants_;
    Buffer<std::uint32_t> nodes_;
    Buffer<std::uint32_t> leaves_;
    Buffer<Triangle> triangles_;
    Buffer<float> attributes_;
    Buffer<SurfaceMaterial> materials_;
    Buffer<SceneFilmLayer> film_layers_;
    Buffer<SceneTexture> textures_;
    Buffer<float> texels_;
    Buffer<SceneLight> lights_;
    Buffer<float> light_cdf_;
    Buffer<std::uint32_t> sobol_table_;
};

} // namespace tristim
