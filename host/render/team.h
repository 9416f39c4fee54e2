#pragma once

#include "render/pass_queue.h"
#include "render/pass_renderer.h"
#include "render/renderer.h"

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace tristim {

/// The passes that limits ask for (of time aside), without those that are done.
PassRanges passes_to_do(const RenderBudget& limits, const PassRanges& done);

/// Renders one scene on several devices. Each takes the next pass when it has done one, so faster ones do more; the
/// image is the sum of the passes, whoever rendered which. If a device fails, what it had lately is rendered anew by
/// the others; from a device that cannot even be read any more, sums are kept as they were moments before.
class Team final : public PassRenderer {
  public:
    /// Builds a renderer on each device, all at the same time. A device where that fails takes no part (see failures)
    /// as long as one is left. Throws Error if the options cannot be rendered or no device is left, and if there are
    /// several but radii follow each pixel's statistics, which passes on one device alone can. `made`, if given, is the
    /// scene on the first device.
    Team(const Scene& scene, const RenderOptions& options, const std::vector<Device>& devices,
         std::shared_ptr<const DeviceScene> made = nullptr);

    /// Goes on from what other renders of this scene with these options have come to. Call it before render, which
    /// then leaves out the passes that these sums hold. Radii are as initial_radii().
    void resume(const RenderSums& sums, const std::vector<float>& radii);

    std::vector<DeviceInfo> devices() const;

    /// The search radius of each pixel in pass 0, scene units. Not while it renders.
    std::vector<float> initial_radii() const;
    void set_initial_radii(const std::vector<float>& radii);

    /// Call it once. Throws Error, before it begins, if radii follow each pixel's statistics and the passes are not
    /// those after the ones that were resumed.
    void render(const RenderBudget& limits, const GoOn& go_on) override;

    /// Instead of render: renders what is given until no device is left or `go_on` says no, which is called at least as
    /// often as `poll` says.
    void render_given(std::chrono::milliseconds poll, const GoOn& go_on);

    /// For the `go_on` of render_given: more passes to be done, those given that are not begun yet, and the seconds
    /// between two passes done (0 before the first).
    void give(const PassRanges& passes);
    std::uint64_t queued() const;
    double pass_seconds() const;

    void request_sums() override;
    std::optional<RenderSums> requested_sums() override;

    /// Also after devices have failed.
    RenderOutcome outcome() override;

    /// Renderer::keep_programs of every device that has not failed.
    void keep_programs() const override;

  private:
    struct Member {
        DeviceInfo device;
        std::unique_ptr<Renderer> renderer; ///< none if it could not be built
        std::string failure;
        RenderSums earlier; ///< of renders before that are on this device: all but the film itself
        std::shared_ptr<const RenderSums> saved = std::make_shared<RenderSums>(); ///< replaced as a whole, see mutex_
        std::uint64_t saved_passes = 0;                                           ///< of its own in it
        std::vector<std::uint32_t> unsaved; ///< the passes after them, the one under way last
        double saved_at = 0.0;              ///< seconds on the stopwatch
        double saving_seconds = 0.0;
        std::uint64_t counted = 0; ///< of its passes, in done_
        bool requested = false;    ///< request_sums waits for it

        RenderSums sums() const;
    };

    void run(const std::optional<double>& seconds, std::chrono::milliseconds poll, const GoOn& go_on);
    void work(std::size_t index, const std::optional<double>& seconds);
    void save(Member& member);
    void save_if_due(Member& member, double now);
    std::vector<std::uint32_t> rescue(Member& member);
    void count(Member& member, std::uint64_t passes);

    RenderOptions options_;
    std::vector<Member> members_;
    std::size_t first_ = 0; ///< of the members, that could be built
    std::unique_ptr<PassQueue> queue_;
    double render_seconds_ = 0.0;
    std::uint64_t done_ = 0;
    bool given_ = false; ///< passes are given while it renders
    bool stopping_ = false;
    mutable std::mutex mutex_; ///< of queue_, done_, stopping_ and of the members' saved and requested
    std::condition_variable changed_;
};

} // namespace tristim
