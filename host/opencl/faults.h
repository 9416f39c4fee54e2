#pragma once

#include "opencl/opencl.h"

#include <memory>
#include <string>

namespace tristim {

/// What tristim asks of an OpenCL device.
enum class DeviceCall { Allocate, Build, Launch, Copy, Wait };

/// A failure of a device that a test provokes; the only way to see what becomes of a render then. In a render it comes
/// from the environment, TRISTIM_FAULT="KIND:COUNT[:PLACE]": on the opened device number PLACE (from 0, the default),
/// the COUNTth (from 1)
///     allocate    allocation of memory finds none left,
///     build       build of a program fails,
///     launch      launch of a kernel finds too few resources,
///     lost        launch, and every call after it, finds no device.
class FaultPlan {
  public:
    /// Throws Error if the text is not as above.
    explicit FaultPlan(const std::string& text);

    int place() const { return place_; }

    /// Counts a call, and throws a ::cl::Error if this is to fail.
    void before(DeviceCall call);

  private:
    enum class Kind { Allocate, Build, Launch, Lost };

    Kind kind_ = Kind::Launch;
    long left_ = 0; ///< calls of that kind until the one that fails
    int place_ = 0;
};

/// The plan of the environment for a device that is the `place`th to be opened; none if there is none.
std::shared_ptr<FaultPlan> fault_plan_from_environment(int place);

} // namespace tristim
