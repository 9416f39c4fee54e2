#include "mpi/pass_server.h"

#include "mpi/rank_messages.h"

#include <algorithm>
#include <utility>

namespace tristim {
namespace {

/// Seconds of work that a rank gets at once; more if rank 0 answers nobody for longer, as when it saves sums.
constexpr double batch_seconds = 0.5;

} // namespace

PassServer::PassServer(Communicator& ranks, PassRanges passes, std::optional<double> seconds)
    : ranks_(ranks), queue_(std::move(passes), static_cast<std::size_t>(ranks.size())), seconds_(seconds) {}

void PassServer::send_all(const Words& words) {
    for (int rank = 0; rank < ranks_.size(); ++rank)
        ranks_.send(rank, words);
}

void PassServer::receive(const Message& message) {
    const auto rank = static_cast<std::size_t>(message.from);
    switch (topic(message.words)) {
    case Topic::Report: {
        const RankReport report = report_of(message.words);
        queue_.report(rank, report.done, report.pass_seconds, stopwatch_.seconds());
        interrupted_ |= report.interrupted && message.from != 0;
        if (report.needs_passes)
            needy_.push_back(message.from);
        break;
    }
    case Topic::Failed: {
        const PassRanges lost = passes_of(message.words);
        queue_.failed(rank, lost);
        std::erase(needy_, message.from);
        ranks_.send(message.from, words(Topic::TakenBack, lost));
        break;
    }
    case Topic::Saved:
        --*unsaved_;
        break;
    default:
        break;
    }
}

void PassServer::request_sums() {
    if (unsaved_ || stopped_)
        return;
    unsaved_ = ranks_.size();
    send_all(about(Topic::Save));
}

void PassServer::serve(bool go_on, double away) {
    if (stopped_)
        return;
    longest_away_ = std::max(longest_away_, away);
    const double now = stopwatch_.seconds();
    const bool late = seconds_ && now >= *seconds_ && queue_.done() > 0;
    if (!go_on || interrupted_ || late || queue_.ended()) {
        stopped_ = true;
        handed_out_ = queue_.handed_out();
        send_all(about(Topic::Stop));
        return;
    }
    std::erase_if(needy_, [&](int rank) {
        const PassRanges batch =
            queue_.take(static_cast<std::size_t>(rank), now, std::max(batch_seconds, 2.0 * longest_away_));
        if (!batch.empty())
            ranks_.send(rank, words(Topic::Passes, batch));
        return !batch.empty();
    });
    if (unsaved_ == 0) {
        unsaved_.reset();
        handed_out_ = queue_.handed_out();
        send_all(about(Topic::Reduce));
    }
}

} // namespace tristim
