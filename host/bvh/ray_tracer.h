#pragma once

#include "bvh/bvh.h"
#include "opencl/buffer.h"
#include "opencl/program.h"

#include <cstdint>
#include <vector>

namespace tristim {

/// The traversal kernel alone (kernels/trace_rays.cl): a BVH on a device, and rays through it.
class RayTracer {
  public:
    RayTracer(const Device& device, const Bvh& bvh, const BuildOptions& options = {});

    /// The nearest hit of each ray at 0 < t < t_max; triangle = -1 and t = t_max where there is none.
    std::vector<RayHit> trace_closest(const std::vector<Ray>& rays);

    /// For each ray, 1 if anything is hit at 0 < t < t_max, else 0.
    std::vector<std::int32_t> trace_any(const std::vector<Ray>& rays);

    /// The parts of the above, to be timed apart: rays go to the device once, then a traversal leaves its results
    /// there.
    void set_rays(const std::vector<Ray>& rays);
    void run_closest();
    void run_any();
    std::vector<RayHit> hits() const { return hits_.read(device_, ray_count_); }
    std::vector<std::int32_t> occluded() const { return occluded_.read(device_, ray_count_); }

  private:
    void run(::cl::Kernel& kernel, const ::cl::Buffer& results);

    Device device_;
    Buffer<std::uint32_t> nodes_;
    Buffer<std::uint32_t> leaves_;
    Buffer<Ray> rays_;
    Buffer<RayHit> hits_;
    Buffer<std::int32_t> occluded_;
    ::cl::Kernel closest_;
    ::cl::Kernel any_;
    std::size_t ray_count_ = 0;
};

/// The macros that a program including kernels/bvh.h needs for this tree. Stack sizes are rounded up, so that most
/// scenes share one compiled program.
Macros traversal_macros(const Bvh& bvh);

} // namespace tristim
