#pragma once

#include "opencl/device.h"
#include "render/options.h"
#include "render/statistics.h"
#include "render/sums.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tristim {
/// What one device did for a render.
struct DeviceShare {
    DeviceInfo device;
    int rank = 0;             ///< of the process that used it, see mpi/communicator.h
    std::uint64_t passes = 0; ///< of its own in the image
    double seconds = 0.0;     ///< rendering
    std::string failure;      ///< why it stopped early, or empty
};

/// What a render has come to.
struct RenderOutcome {
    RenderSums sums;
    RenderStatistics statistics; ///< of all devices, passes and photons of earlier renders among them; buffers are
                                 ///< those of the first
    std::vector<DeviceShare> shares;
    bool stopped_elsewhere = false; ///< because another process wanted no more
};

/// Renders the passes of an image somewhere.
class PassRenderer {
  public:
    /// Whether to go on after so many passes.
    using GoOn = std::function<bool(std::uint64_t passes)>;

    virtual ~PassRenderer() = default;

    /// Renders passes until a limit is reached, no device is left or `go_on` says no; that is called now and then with
    /// the passes done by this call, from this thread.
    virtual void render(const RenderBudget& limits, const GoOn& go_on) = 0;

    /// For `go_on`: has all sums saved as soon as the passes under way are done, and then gives them; none until then.
    virtual void request_sums() = 0;
    virtual std::optional<RenderSums> requested_sums() = 0;

    /// What it took to add up the last of them while all waited, seconds.
    virtual double summing_seconds() const { return 0.0; }

    /// What the render has come to; after it.
    virtual RenderOutcome outcome() = 0;

    /// Puts programs into the cache, see Renderer.
    virtual void keep_programs() const = 0;
};

} // namespace tristim
