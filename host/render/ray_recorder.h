#pragma once

#include "opencl/buffer.h"
#include "shared_types.h"

#include <cstdint>
#include <vector>

namespace tristim {

/// Where the kernels of one render write their rays (record_ray of kernels/scene.h).
class RayRecorder {
  public:
    RayRecorder() = default;

    /// With room for `capacity` rays; those beyond are dropped.
    RayRecorder(const Device& device, std::size_t capacity);

    /// Forgets what is recorded.
    void clear(const Device& device) const;

    /// The rays recorded since.
    std::vector<Ray> read(const Device& device) const;

    const Buffer<Ray>& rays() const { return rays_; }
    const Buffer<std::uint32_t>& count() const { return count_; }

  private:
    Buffer<Ray> rays_;
    Buffer<std::uint32_t> count_; ///< rays written or dropped, and the capacity
};

} // namespace tristim
