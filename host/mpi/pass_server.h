#pragma once

#include "base/stopwatch.h"
#include "mpi/batch_queue.h"
#include "mpi/communicator.h"

#include <optional>
#include <vector>

namespace tristim {

/// What rank 0 does for all beside rendering: hands out passes, has sums saved and reduced, and ends the render.
class PassServer {
  public:
    PassServer(Communicator& ranks, PassRanges passes, std::optional<double> seconds);

    /// What a rank has told.
    void receive(const Message& message);

    /// Answers what is open; call it when all messages have been received. `go_on` is whether the user wants more,
    /// `away` for how many seconds messages have lain before they were looked at.
    void serve(bool go_on, double away);

    /// Has all ranks save and reduce their sums, once they have come to it.
    void request_sums();

    std::uint64_t done() const { return queue_.done(); }

    /// Whether another rank wanted no more.
    bool interrupted() const { return interrupted_; }

    /// The passes that ranks had, done or not, when the last message of topic Reduce or Stop went out.
    const PassRanges& handed_out() const { return handed_out_; }

  private:
    void send_all(const Words& words);

    Communicator& ranks_;
    BatchQueue queue_;
    std::optional<double> seconds_;
    Stopwatch stopwatch_;
    std::vector<int> needy_; ///< ranks that need passes
    PassRanges handed_out_;
    std::optional<int> unsaved_; ///< ranks that are still to save their sums
    double longest_away_ = 0.0;  ///< s
    bool interrupted_ = false;
    bool stopped_ = false;
};

} // namespace tristim
