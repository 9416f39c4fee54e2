#pragma once

#include "render/pass_queue.h"
#include "render/renderer.h"

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace tristim {

/// What one device did for a render.
struct DeviceShare {
    DeviceInfo device;
    std::uint64_t passes = 0; ///< in the image
    double seconds = 0.0;     ///< rendering
    std::string failure;      ///< why it stopped early, or empty
};

/// What a render has come to.
struct RenderOutcome {
    RenderSums sums;
    RenderStatistics statistics; ///< of all devices; buffers are those of the first
    std::vector<DeviceShare> shares;
};

/// Renders one scene on several devices. Each takes the next pass when it has done one, so faster ones do more; the
/// image is the sum of the passes, whoever rendered which. If a device fails, what it had lately is rendered anew by
/// the others; from a device that cannot even be read any more, sums are kept as they were moments before.
class Team {
  public:
    /// Builds a renderer on each device, all at the same time. A device where that fails takes no part (see failures)
    /// as long as one is left. Throws Error if the options cannot be rendered or no device is left, and if there are
    /// several but radii follow each pixel's statistics, which passes on one device alone can. `made`, if given, is the
    /// scene on the first device.
    Team(const Scene& scene, const RenderOptions& options, const std::vector<Device>& devices,
         std::shared_ptr<const DeviceScene> made = nullptr);

    /// Renders passes until a limit is reached, no device is left or `go_on` says no; that is called now and then with
    /// the passes done, from this thread. Call it once.
    void render(const RenderBudget& limits, const std::function<bool(std::uint64_t passes)>& go_on);

    /// Also after devices have failed.
    RenderOutcome outcome();

    /// Renderer::keep_programs of every device that has not failed.
    void keep_programs() const;

  private:
    struct Member {
        DeviceInfo device;
        std::unique_ptr<Renderer> renderer; ///< none if it could not be built
        std::string failure;
        RenderSums saved; ///< of saved_passes passes
        std::uint64_t saved_passes = 0;
        std::vector<std::uint32_t> unsaved; ///< the passes after them, the one under way last
        double saved_at = 0.0;              ///< seconds on the stopwatch
        double saving_seconds = 0.0;
        std::uint64_t counted = 0; ///< of its passes, in done_

        void save();
    };

    void work(std::size_t index, const RenderBudget& limits);
    void render_pass(Member& member, double now);
    static std::vector<std::uint32_t> rescue(Member& member);
    void count(Member& member, std::uint64_t passes);

    RenderOptions options_;
    std::vector<Member> members_;
    std::unique_ptr<PassQueue> queue_;
    double render_seconds_ = 0.0;
    std::uint64_t done_ = 0;
    bool stopping_ = false;
    std::mutex mutex_; ///< of queue_, done_ and stopping_
    std::condition_variable changed_;
};

} // namespace tristim
