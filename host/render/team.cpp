#include "render/team.h"

#include "base/error.h"
#include "base/stopwatch.h"
#include "opencl/errors.h"
#include "render/pilot.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <thread>

namespace tristim {
namespace {

/// Sums are saved from a device when so many times the time has gone by that saving took: half a percent of a render.
constexpr double seconds_per_saving_second = 200.0;

/// Whether they are all passes up to one.
bool begin_the_image(const PassRanges& passes) {
    return passes.empty() || passes == PassRanges(0, passes.ranges().front().end);
}

} // namespace

PassRanges passes_to_do(const RenderBudget& limits, const PassRanges& done) {
    const std::uint64_t left = pilot_pass - limits.first_pass;
    const auto count = static_cast<std::uint32_t>(std::min(limits.passes.value_or(left), left));
    return done.missing(limits.first_pass, limits.first_pass + count);
}

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
            member.failure = describe_current_exception();
        }
    };
    std::vector<std::thread> threads;
    for (std::size_t i = 1; i < devices.size(); ++i)
        threads.emplace_back(build, i);
    build(0);
    for (std::thread& thread : threads)
        thread.join();

    const auto built =
        std::find_if(members_.begin(), members_.end(), [](const Member& member) { return member.renderer != nullptr; });
    if (built == members_.end())
        fail("{}", members_.front().failure);
    first_ = static_cast<std::size_t>(built - members_.begin());
    const std::vector<float> radii = initial_radii();
    for (auto member = built + 1; member < members_.end(); ++member) {
        if (member->renderer)
            member->renderer->set_initial_radii(radii);
    }
}

std::vector<DeviceInfo> Team::devices() const {
    std::vector<DeviceInfo> devices;
    for (const Member& member : members_)
        devices.push_back(member.device);
    return devices;
}

void Team::set_initial_radii(const std::vector<float>& radii) {
    for (Member& member : members_) {
        if (member.renderer)
            member.renderer->set_initial_radii(radii);
    }
}

std::vector<float> Team::initial_radii() const {
    return members_[first_].renderer->initial_radii();
}

void Team::resume(const RenderSums& sums, const std::vector<float>& radii) {
    set_initial_radii(radii);
    // On a device alone, passes go on being added as if there had been no pause.
    Member& member = members_[first_];
    member.renderer->restore(sums.film, 0, 0.0);
    member.renderer->restore_error_sums(sums.error);
    member.saved = std::make_shared<RenderSums>(sums);
    member.earlier = {{}, {}, sums.passes, sums.rays, sums.non_finite, sums.photons_stored};
    member.earlier.rays.camera = member.earlier.rays.shadow = member.earlier.non_finite.film =
        0; // the film counts them
}

void Team::render(const RenderBudget& limits, const GoOn& go_on) {
    const PassRanges earlier = members_[first_].earlier.passes;
    const PassRanges passes = passes_to_do(limits, earlier);
    if (options_.statistics_radius) {
        PassRanges all = earlier;
        all.add(passes);
        if (!begin_the_image(earlier) || !begin_the_image(all))
            fail("--radius statistics needs each pass after those before it: passes {} cannot follow {}", passes.text(),
                 earlier.empty() ? "none" : earlier.text());
    }
    queue_ = std::make_unique<PassQueue>(passes, members_.size());
    run(limits.seconds, std::chrono::milliseconds(50), go_on);
}

void Team::render_given(std::chrono::milliseconds poll, const GoOn& go_on) {
    given_ = true;
    queue_ = std::make_unique<PassQueue>(PassRanges(), members_.size());
    run({}, poll, go_on);
}

void Team::give(const PassRanges& passes) {
    const std::lock_guard lock(mutex_);
    queue_->add(passes);
    changed_.notify_all();
}

std::uint64_t Team::queued() const {
    const std::lock_guard lock(mutex_);
    return queue_->left();
}

double Team::pass_seconds() const {
    const std::lock_guard lock(mutex_);
    return queue_->pass_seconds();
}

/// Has every device's thread work on the queue.
void Team::run(const std::optional<double>& seconds, std::chrono::milliseconds poll, const GoOn& go_on) {
    const Stopwatch stopwatch;
    std::size_t working = 0;
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < members_.size(); ++i) {
        if (!members_[i].renderer) {
            queue_->failed(i, {});
            continue;
        }
        ++working;
        threads.emplace_back([this, i, &seconds, &working] {
            work(i, seconds);
            const std::lock_guard lock(mutex_);
            --working;
            changed_.notify_all();
        });
    }
    std::exception_ptr failure; // of go_on
    std::unique_lock lock(mutex_);
    while (working > 0) {
        changed_.wait_for(lock, poll);
        const std::uint64_t done = done_;
        lock.unlock();
        bool stop = true;
        try {
            stop = failure || !go_on(done);
        } catch (...) { // the threads must end first
            failure = std::current_exception();
        }
        lock.lock();
        stopping_ |= stop;
        if (stop)
            changed_.notify_all();
    }
    lock.unlock();
    for (std::thread& thread : threads)
        thread.join();
    render_seconds_ = stopwatch.seconds();
    if (failure)
        std::rethrow_exception(failure);
}

/// What a device's thread does.
void Team::work(std::size_t index, const std::optional<double>& seconds) {
    Member& member = members_[index];
    const Stopwatch stopwatch;
    std::unique_lock lock(mutex_);
    for (;;) {
        const bool late = seconds && stopwatch.seconds() >= *seconds && (done_ > 0 || queue_->busy());
        if (stopping_ || late || (!given_ && queue_->empty() && !queue_->busy()))
            return;
        const std::optional<std::uint32_t> pass = queue_->take(index, stopwatch.seconds());
        if (!pass && !member.requested) {
            changed_.wait_for(lock, std::chrono::milliseconds(50));
            continue;
        }
        lock.unlock();
        try {
            if (pass) {
                member.unsaved.push_back(*pass);
                member.renderer->render_pass(*pass);
            }
            save_if_due(member, stopwatch.seconds());
        } catch (const std::exception&) {
            member.failure = describe_current_exception();
            const std::vector<std::uint32_t> lost = rescue(member);
            lock.lock();
            count(member, member.saved_passes);
            queue_->failed(index, lost);
            member.requested = false;
            changed_.notify_all();
            return;
        }
        lock.lock();
        count(member, member.saved_passes + member.unsaved.size());
        if (pass)
            queue_->done(index, stopwatch.seconds());
        changed_.notify_all();
    }
}

void Team::count(Member& member, std::uint64_t passes) {
    done_ = done_ - member.counted + passes;
    member.counted = passes;
}

void Team::request_sums() {
    const std::lock_guard lock(mutex_);
    for (Member& member : members_)
        member.requested = member.renderer && member.failure.empty();
    changed_.notify_all();
}

std::optional<RenderSums> Team::requested_sums() {
    std::vector<std::shared_ptr<const RenderSums>> saved;
    {
        const std::lock_guard lock(mutex_);
        for (const Member& member : members_) {
            if (member.requested)
                return {};
            saved.push_back(member.saved);
        }
    }
    RenderSums sums;
    for (const auto& part : saved)
        add(sums, *part);
    return sums;
}

/// All on the device, that of earlier renders included, of passes that the device does not know.
RenderSums Team::Member::sums() const {
    RenderSums sums = renderer->sums();
    sums.rays.photon += earlier.rays.photon;
    sums.non_finite.eye += earlier.non_finite.eye;
    sums.non_finite.photon += earlier.non_finite.photon;
    sums.non_finite.gather += earlier.non_finite.gather;
    sums.photons_stored += earlier.photons_stored;
    return sums;
}

void Team::save_if_due(Member& member, double now) {
    bool requested = false;
    {
        const std::lock_guard lock(mutex_);
        requested = member.requested;
    }
    if (!requested && now - member.saved_at < seconds_per_saving_second * member.saving_seconds)
        return;
    const Stopwatch saving;
    save(member);
    member.saving_seconds = saving.seconds();
    member.saved_at = now;
}

void Team::save(Member& member) {
    auto sums = std::make_shared<RenderSums>(member.sums());
    sums->passes = member.saved->passes;
    sums->passes.add(PassRanges::of(member.unsaved));
    const std::lock_guard lock(mutex_);
    member.saved = std::move(sums);
    member.saved_passes += member.unsaved.size();
    member.unsaved.clear();
    member.requested = false;
}

/// After a failure in the last of the unsaved passes: saves what the device still holds, if that is whole. The passes
/// that are lost.
std::vector<std::uint32_t> Team::rescue(Member& member) {
    std::vector<std::uint32_t> lost = member.unsaved;
    member.unsaved.clear();
    try {
        const std::vector<FilmPixel> film = member.renderer->film_pixels();
        for (const std::size_t missing : {std::size_t{0}, std::size_t{1}}) {
            const std::uint64_t passes = member.saved->passes.count() + lost.size() - missing;
            if (lost.size() < missing || !holds_passes(film, passes))
                continue;
            const auto rest = lost.end() - static_cast<std::ptrdiff_t>(missing);
            member.unsaved.assign(lost.begin(), rest);
            save(member);
            lost.erase(lost.begin(), rest);
            break;
        }
    } catch (const std::exception&) {
        // The device cannot be read any more: what was saved before stays.
        member.unsaved.clear();
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
        DeviceShare share{member.device, 0, 0, 0.0, member.failure};
        if (member.renderer) {
            if (member.failure.empty()) {
                try {
                    save(member);
                } catch (const std::exception&) {
                    share.failure = describe_current_exception();
                }
            }
            const RenderStatistics& statistics = member.renderer->statistics();
            share.passes = member.saved_passes;
            share.seconds = statistics.render_seconds;
            add(outcome.sums, *member.saved);
            if (first)
                outcome.statistics = statistics;
            else
                add_work(outcome.statistics, statistics);
            first = false;
        }
        outcome.shares.push_back(share);
    }
    outcome.statistics.passes = outcome.sums.passes.count();
    outcome.statistics.photons_stored = outcome.sums.photons_stored;
    outcome.statistics.photons_emitted =
        outcome.statistics.passes * static_cast<std::uint64_t>(options_.photons_per_pass);
    outcome.statistics.render_seconds = render_seconds_;
    return outcome;
}

} // namespace tristim
