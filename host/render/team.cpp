#include "render/team.h"

#include "base/error.h"
#include "base/stopwatch.h"
#include "opencl/errors.h"
#include "render/pilot.h"

#include <algorithm>
#include <chrono>
#include <thread>

namespace tristim {
namespace {

/// Sums are saved from a device when so many times the time has gone by that saving took: half a percent of a render.
constexpr double seconds_per_saving_second = 200.0;

/// What went wrong, of the exception that is being handled.
std::string reason() {
    try {
        throw;
    } catch (const ::cl::Error& error) {
        return describe_opencl_error(error);
    } catch (const std::exception& error) {
        return error.what();
    }
}

} // namespace

Team::Team(const Scene& scene, const RenderOptions& options, const std::vector<Device>& devices,
           std::shared_ptr<const DeviceScene> made)
    : options_(options), members_(devices.size()) {
    check_options(options);
    if (options.statistics_radius && devices.size() > 1)
        fail("--radius statistics needs each pass after those before it, so one --device, not {}", devices.size());
    const auto build = [&](std::size_t i) {
        Member& member = members_[i];
        member.device = devices[i].info;
        try {
            member.renderer = i == 0 && made ? std::make_unique<Renderer>(made, options, devices[i])
                                             : std::make_unique<Renderer>(scene, options, devices[i]);
        } catch (const std::exception&) {
            member.failure = reason();
        }
    };
    std::vector<std::thread> threads;
    for (std::size_t i = 1; i < devices.size(); ++i)
        threads.emplace_back(build, i);
    build(0);
    for (std::thread& thread : threads)
        thread.join();

    const Member* first = nullptr;
    for (Member& member : members_) {
        if (!member.renderer)
            continue;
        if (first == nullptr)
            first = &member;
        else
            member.renderer->set_initial_radii(first->renderer->initial_radii());
    }
    if (first == nullptr)
        fail("{}", members_.front().failure);
}

void Team::render(const RenderBudget& limits, const std::function<bool(std::uint64_t)>& go_on) {
    const Stopwatch stopwatch;
    queue_ = std::make_unique<PassQueue>(std::min<std::uint64_t>(limits.passes.value_or(pilot_pass), pilot_pass),
                                         members_.size());
    std::size_t working = 0;
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < members_.size(); ++i) {
        if (!members_[i].renderer) {
            queue_->failed(i, {});
            continue;
        }
        ++working;
        threads.emplace_back([this, i, &limits, &working] {
            work(i, limits);
            const std::lock_guard lock(mutex_);
            --working;
            changed_.notify_all();
        });
    }
    std::unique_lock lock(mutex_);
    while (working > 0) {
        changed_.wait_for(lock, std::chrono::milliseconds(50));
        const std::uint64_t done = done_;
        lock.unlock();
        const bool stop = !go_on(done);
        lock.lock();
        stopping_ |= stop;
        if (stop)
            changed_.notify_all();
    }
    lock.unlock();
    for (std::thread& thread : threads)
        thread.join();
    render_seconds_ = stopwatch.seconds();
}

/// What a device's thread does.
void Team::work(std::size_t index, const RenderBudget& limits) {
    Member& member = members_[index];
    const Stopwatch stopwatch;
    std::unique_lock lock(mutex_);
    for (;;) {
        const bool late = limits.seconds && stopwatch.seconds() >= *limits.seconds && (done_ > 0 || queue_->busy());
        if (stopping_ || late || (queue_->empty() && !queue_->busy()))
            return;
        const std::optional<std::uint32_t> pass = queue_->take(index, stopwatch.seconds());
        if (!pass) {
            changed_.wait_for(lock, std::chrono::milliseconds(50));
            continue;
        }
        lock.unlock();
        member.unsaved.push_back(*pass);
        try {
            render_pass(member, stopwatch.seconds());
        } catch (const std::exception&) {
            member.failure = reason();
            const std::vector<std::uint32_t> lost = rescue(member);
            lock.lock();
            count(member, member.saved_passes);
            queue_->failed(index, lost);
            changed_.notify_all();
            return;
        }
        lock.lock();
        count(member, member.saved_passes + member.unsaved.size());
        queue_->done(index, stopwatch.seconds());
        changed_.notify_all();
    }
}

void Team::count(Member& member, std::uint64_t passes) {
    done_ = done_ - member.counted + passes;
    member.counted = passes;
}

void Team::render_pass(Member& member, double now) {
    member.renderer->render_pass(member.unsaved.back());
    if (now - member.saved_at < seconds_per_saving_second * member.saving_seconds)
        return;
    const Stopwatch saving;
    member.save();
    member.saving_seconds = saving.seconds();
    member.saved_at = now;
}

void Team::Member::save() {
    saved = renderer->sums();
    saved_passes += unsaved.size();
    unsaved.clear();
}

/// After a failure in the last of the unsaved passes: saves what the device still holds, if that is whole. The passes
/// that are lost.
std::vector<std::uint32_t> Team::rescue(Member& member) {
    std::vector<std::uint32_t> lost;
    lost.swap(member.unsaved);
    try {
        RenderSums sums = member.renderer->sums();
        for (const std::size_t missing : {std::size_t{0}, std::size_t{1}}) {
            const std::uint64_t passes = member.saved_passes + lost.size() - missing;
            if (lost.size() < missing || !holds_passes(sums, passes))
                continue;
            member.saved = std::move(sums);
            member.saved_passes = passes;
            lost.erase(lost.begin(), lost.end() - static_cast<std::ptrdiff_t>(missing));
            break;
        }
    } catch (const std::exception&) {
        // The device cannot be read any more: what was saved before stays.
    }
    return lost;
}

void Team::keep_programs() const {
    for (const Member& member : members_) {
        if (member.renderer && member.failure.empty())
            member.renderer->keep_programs();
    }
}

RenderOutcome Team::outcome() {
    RenderOutcome outcome;
    bool first = true;
    for (Member& member : members_) {
        DeviceShare share{member.device, 0, 0.0, member.failure};
        if (member.renderer) {
            if (member.failure.empty()) {
                try {
                    member.save();
                } catch (const std::exception&) {
                    share.failure = reason();
                }
            }
            const RenderStatistics& statistics = member.renderer->statistics();
            share.passes = member.saved_passes;
            share.seconds = statistics.render_seconds;
            add(outcome.sums, member.saved);
            if (first)
                outcome.statistics = statistics;
            else
                add_work(outcome.statistics, statistics);
            first = false;
        }
        outcome.shares.push_back(share);
    }
    outcome.statistics.passes = 0;
    for (const DeviceShare& share : outcome.shares)
        outcome.statistics.passes += share.passes;
    outcome.statistics.photons_emitted =
        outcome.statistics.passes * static_cast<std::uint64_t>(options_.photons_per_pass);
    outcome.statistics.render_seconds = render_seconds_;
    return outcome;
}

} // namespace tristim
