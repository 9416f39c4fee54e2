#pragma once

#include "bvh/bvh.h"
#include "opencl/buffer.h"
#include "opencl/program.h"
#include "selftest/case.h"

#include <string>
#include <vector>

namespace tristim::selftest {

/// A mesh on a device as a scene's is: its tree, and its triangles as the shading sees them.
struct GeometryMesh {
    GeometryMesh(const Device& device, const TriangleSoup& triangles);

    TriangleSoup soup;
    std::vector<Triangle> triangles;
    Buffer<std::uint32_t> nodes;
    Buffer<std::uint32_t> leaves;
    Buffer<Triangle> on_device;
};

/// The kernels of kernels/selftest/geometry.cl.
class GeometryKernels {
  public:
    explicit GeometryKernels(const Setting& setting);

    /// Kernels from other text, for tests.
    GeometryKernels(const Device& device, const std::string& text);

    const Device& device() const { return device_; }

    /// Ray i against leaf i alone.
    std::vector<RayHit> hit_leaves(const BvhBlocks& leaves, const std::vector<Ray>& rays) const;

    std::vector<RayHit> closest(const GeometryMesh& mesh, const std::vector<Ray>& rays) const;
    std::vector<std::int32_t> any(const GeometryMesh& mesh, const std::vector<Ray>& rays) const;

    /// Rays in the given directions from where others hit; those must have hit.
    std::vector<Ray> leave(const GeometryMesh& mesh, const std::vector<RayHit>& hits,
                           const std::vector<cl_float4>& directions) const;

    /// Shadow rays from where rays hit to points u of an area light.
    std::vector<Ray> shadows(const GeometryMesh& mesh, const std::vector<RayHit>& hits, const SceneLight& light,
                             const std::vector<cl_float4>& u) const;

    /// Photons' first rays from an area light.
    std::vector<Ray> emitted(const SceneLight& light, const std::vector<cl_float4>& u) const;

  private:
    template <typename... Arguments>
    void run(const char* kernel, std::size_t count, const Arguments&... arguments) const;

    Device device_;
    ::cl::Program program_;
};

} // namespace tristim::selftest
