#include "mpi/joint_render.h"

#include "base/error.h"
#include "base/stopwatch.h"
#include "mpi/rank_messages.h"
#include "mpi/rank_outcome.h"

#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

namespace tristim {
namespace {

/// How often messages are looked for.
constexpr std::chrono::milliseconds poll{5};

/// A rank asks for more when it has work for so many seconds: an answer takes some times `poll`.
constexpr double ask_seconds = 0.1;

} // namespace

JointRender::JointRender(Communicator& ranks, const RenderOptions& options, std::unique_ptr<Team> team,
                         std::string failure, PassRanges earlier)
    : ranks_(ranks), options_(options), team_(std::move(team)), failure_(std::move(failure)),
      earlier_(std::move(earlier)) {
    const std::vector<float> own = ranks.rank() == 0 ? team_->initial_radii() : std::vector<float>();
    const std::string bytes = ranks.broadcast({reinterpret_cast<const char*>(own.data()), own.size() * sizeof(float)});
    if (ranks.rank() != 0 && team_) {
        std::vector<float> radii(bytes.size() / sizeof(float));
        std::memcpy(radii.data(), bytes.data(), bytes.size());
        team_->set_initial_radii(radii);
    }
}

void JointRender::render(const RenderBudget& limits, const GoOn& go_on) {
    const Stopwatch stopwatch;
    if (ranks_.rank() == 0)
        server_ = std::make_unique<PassServer>(ranks_, passes_to_do(limits, earlier_), limits.seconds);
    if (team_)
        team_->render_given(poll, [&](std::uint64_t done) { return step(done, go_on); });
    if (!stopped_) {
        const std::uint64_t done = give_up();
        while (step(done, go_on))
            std::this_thread::sleep_for(poll);
    }
    render_seconds_ = stopwatch.seconds();
}

/// No device is left: hands back what is not in the sums. How many passes are.
std::uint64_t JointRender::give_up() {
    PassRanges held;
    if (team_) {
        team_->request_sums();
        held = team_->requested_sums()->passes;
    }
    failed_ = true;
    const PassRanges lost = given_.without(held);
    const std::uint64_t done = given_count_ - lost.count();
    ranks_.send(0, words(RankReport{done, 0.0, false, interrupted_}));
    ranks_.send(0, words(Topic::Failed, lost));
    return done;
}

bool JointRender::step(std::uint64_t done, const GoOn& go_on) {
    const Stopwatch away;
    while (const std::optional<Message> message = ranks_.receive()) {
        const Topic about = topic(message->words);
        if (about == Topic::Report || about == Topic::Failed || about == Topic::Saved)
            server_->receive(*message);
        else
            follow(*message);
    }
    interrupted_ = !go_on(server_ ? server_->done() : done);
    if (server_)
        server_->serve(!interrupted_, away.seconds());
    if (saving_)
        save();
    report(done);
    return !stopped_;
}

/// Does what rank 0 says.
void JointRender::follow(const Message& message) {
    switch (topic(message.words)) {
    case Topic::Passes: {
        const PassRanges passes = passes_of(message.words);
        given_.add(passes);
        given_count_ += passes.count();
        asked_ = false;
        if (failed_)
            ranks_.send(0, words(Topic::Failed, passes)); // they were on their way
        else
            team_->give(passes);
        break;
    }
    case Topic::TakenBack:
        given_ = given_.without(passes_of(message.words));
        break;
    case Topic::Save:
        if (team_)
            team_->request_sums();
        saving_ = true;
        break;
    case Topic::Reduce: {
        RenderSums sums = reduced(std::move(saved_));
        if (server_)
            total_ = std::move(sums);
        break;
    }
    default:
        stopped_ = true;
    }
}

/// Tells rank 0 when the sums that it asked for are there.
void JointRender::save() {
    std::optional<RenderSums> sums = team_ ? team_->requested_sums() : RenderSums{};
    if (!sums)
        return;
    saved_ = std::move(*sums);
    saving_ = false;
    ranks_.send(0, about(Topic::Saved));
}

/// Tells rank 0 how far this rank is, when it needs more passes or has done all.
void JointRender::report(std::uint64_t done) {
    const double pass_seconds = failed_ ? 0.0 : team_->pass_seconds();
    const bool needs = !failed_ && !asked_ && static_cast<double>(team_->queued()) * pass_seconds < ask_seconds;
    const bool all_done = done == given_count_ && done != reported_done_;
    const bool interrupted_now = interrupted_ && !std::exchange(told_interrupted_, true);
    if (!needs && !interrupted_now && (failed_ || !all_done))
        return;
    ranks_.send(0, words(RankReport{done, pass_seconds, needs, interrupted_}));
    asked_ |= needs;
    reported_done_ = done;
}

void JointRender::request_sums() {
    if (!server_)
        return;
    total_.reset();
    server_->request_sums();
}

std::optional<RenderSums> JointRender::requested_sums() {
    return total_;
}

/// All: the sum of what all ranks pass, at rank 0.
RenderSums JointRender::reduced(RenderSums sums) {
    const Stopwatch stopwatch;
    const PassRanges missing = given_.without(sums.passes);
    const std::vector<std::string> counts = ranks_.gather(counts_text(sums, missing));
    sums.film.resize(options_.region.pixels());
    ranks_.reduce(sums.film);
    sums.error.resize(options_.error_estimate ? ERROR_PLANES * options_.region.pixels() : 0);
    ranks_.reduce(sums.error);
    if (!server_)
        return sums;
    RenderSums total;
    total.film = std::move(sums.film);
    total.error = std::move(sums.error);
    total.passes = server_->handed_out();
    for (const std::string& text : counts)
        add_counts(text, total);
    total.passes.add(earlier_);
    summing_seconds_ = stopwatch.seconds();
    if (!holds_passes(total.film, total.passes.count()))
        fail("the ranks' sums do not hold the {} passes that they tell of", total.passes.count());
    return total;
}

RenderOutcome JointRender::outcome() {
    RenderOutcome outcome = team_ ? team_->outcome() : RenderOutcome{};
    if (!team_)
        outcome.shares.emplace_back().failure = failure_;
    const std::vector<std::string> parts = ranks_.gather(outcome_text(outcome));
    outcome.sums = reduced(std::move(outcome.sums));
    for (std::size_t rank = 1; rank < parts.size(); ++rank)
        add_outcome(parts[rank], static_cast<int>(rank), outcome);
    outcome.stopped_elsewhere = server_ && server_->interrupted();
    outcome.statistics.render_seconds = render_seconds_;
    outcome.statistics.passes = outcome.sums.passes.count();
    outcome.statistics.photons_stored = outcome.sums.photons_stored;
    outcome.statistics.photons_emitted =
        outcome.statistics.passes * static_cast<std::uint64_t>(options_.photons_per_pass);
    return outcome;
}

/// Ranks on a machine have the same cache, so one of them writes it.
void JointRender::keep_programs() const {
    if (team_ && ranks_.local_rank() == 0)
        team_->keep_programs();
}

} // namespace tristim
