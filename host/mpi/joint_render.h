#pragma once

#include "mpi/communicator.h"
#include "mpi/pass_server.h"
#include "render/team.h"

#include <memory>
#include <optional>

namespace tristim {

/// Renders one scene on the devices of several ranks: rank 0 hands out passes to all, itself included, by the speed
/// that they show, and adds up what they have come to. The image is that of one rank, since a sum of passes does not
/// depend on who rendered them. All ranks make one with the same options.
class JointRender final : public PassRenderer {
  public:
    /// Rank 0 has a team, which other ranks lack if theirs could not be built, for the reason given. All take the
    /// initial radii of rank 0. `earlier` are the passes that rank 0's team has resumed.
    JointRender(Communicator& ranks, const RenderOptions& options, std::unique_ptr<Team> team, std::string failure = {},
                PassRanges earlier = {});

    /// All ranks call it; the limits are those of rank 0. It ends when `go_on` of any rank says no, which is called
    /// with the passes done: at rank 0 by all, elsewhere by this rank.
    void render(const RenderBudget& limits, const GoOn& go_on) override;

    /// At rank 0: the sums of all ranks. Elsewhere they are not to be had.
    void request_sums() override;
    std::optional<RenderSums> requested_sums() override;

    double summing_seconds() const override { return summing_seconds_; }

    /// All ranks call it. At rank 0 of all ranks, elsewhere of this one.
    RenderOutcome outcome() override;

    void keep_programs() const override;

  private:
    bool step(std::uint64_t done, const GoOn& go_on);
    void follow(const Message& message);
    void save();
    void report(std::uint64_t done);
    std::uint64_t give_up();
    RenderSums reduced(RenderSums sums);

    Communicator& ranks_;
    RenderOptions options_;
    std::unique_ptr<Team> team_;
    std::string failure_; ///< why there is no team
    PassRanges earlier_;
    double render_seconds_ = 0.0;
    double summing_seconds_ = 0.0;
    std::unique_ptr<PassServer> server_; ///< of rank 0
    PassRanges given_;                   ///< what this rank is to do or has done
    std::uint64_t given_count_ = 0;
    std::uint64_t reported_done_ = 0;
    bool asked_ = false; ///< for passes
    bool interrupted_ = false;
    bool told_interrupted_ = false;
    bool failed_ = false;
    bool stopped_ = false;
    bool saving_ = false;
    RenderSums saved_;                ///< what is to be reduced
    std::optional<RenderSums> total_; ///< at rank 0: what has been reduced
};

} // namespace tristim
