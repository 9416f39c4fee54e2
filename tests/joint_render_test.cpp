// Several ranks render one image: host/mpi/joint_render.h. Here they are threads; tests/mpirun_test.cpp has processes.

#include "all_take_part.h"
#include "mpi/joint_render.h"
#include "test_scenes.h"
#include "thread_ranks.h"

#include <cstring>
#include <gtest/gtest.h>
#include <optional>
#include <utility>

namespace tristim::test {
namespace {

constexpr std::uint64_t passes = 60;

RenderOptions options() {
    RenderOptions options = small_render("tristimulus:2", 16, 12, 2048, 0.1, 16);
    options.radius.reset();
    return options;
}

const Scene& scene() {
    static const Scene loaded = load_scene(TRISTIM_SOURCE_DIR "/meshes/dispersion/scene.pbrt");
    return loaded;
}

std::unique_ptr<Team> team(const std::string& fault = "") {
    Device device = open_device(std::to_string(test_device().info.index));
    if (!fault.empty())
        device.faults = std::make_shared<FaultPlan>(fault);
    return std::make_unique<Team>(scene(), options(), std::vector{device});
}

/// The sums of passes that one team has rendered.
RenderSums alone(const RenderBudget& limits) {
    const std::unique_ptr<Team> one = team();
    one->render(limits, [](std::uint64_t) { return true; });
    return one->outcome().sums;
}

const RenderSums& expected() {
    static const RenderSums sums = alone({passes, {}});
    return sums;
}

void expect_same_image(const RenderSums& a, const RenderSums& b) {
    const auto x = developed(a, options()).xyz, y = developed(b, options()).xyz;
    ASSERT_EQ(x.size(), y.size());
    EXPECT_EQ(std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])), 0);
}

/// What ranks come to on whose devices this fails ("": nothing; "none": there is no device).
RenderOutcome render(
    const std::vector<std::string>& faults,
    const std::function<bool(PassRenderer&, Communicator&, std::uint64_t)>& go_on =
        [](PassRenderer&, Communicator&, std::uint64_t) { return true; }) {
    RenderOutcome outcome;
    ThreadRanks ranks(static_cast<int>(faults.size()));
    ranks.run([&](Communicator& rank) {
        const std::string& fault = faults[static_cast<std::size_t>(rank.rank())];
        JointRender joint(rank, options(), fault == "none" ? nullptr : team(fault), "it has none");
        joint.render({passes, {}}, [&](std::uint64_t done) { return go_on(joint, rank, done); });
        RenderOutcome own = joint.outcome();
        if (rank.rank() == 0)
            outcome = std::move(own);
    });
    return outcome;
}

TEST(JointRender, RanksDoNotShowInTheImage) {
    const RenderOutcome outcome = render_until_all_take_part([] { return render({"", "", ""}); });
    expect_same_image(outcome.sums, expected());
    EXPECT_EQ(outcome.sums.passes, PassRanges(0, passes));
    EXPECT_EQ(outcome.sums.photons_stored, expected().photons_stored);
    EXPECT_EQ(outcome.sums.rays.camera, expected().rays.camera);
    EXPECT_EQ(outcome.sums.rays.shadow, expected().rays.shadow);
    EXPECT_EQ(outcome.sums.rays.photon, expected().rays.photon);
    EXPECT_EQ(outcome.statistics.passes, passes);
    EXPECT_EQ(outcome.statistics.photons_emitted, passes * 2048);
    EXPECT_FALSE(outcome.stopped_elsewhere);
    ASSERT_EQ(outcome.shares.size(), 3U);
    std::uint64_t sum = 0;
    for (int rank = 0; rank < 3; ++rank) {
        const DeviceShare& share = outcome.shares[static_cast<std::size_t>(rank)];
        EXPECT_EQ(share.rank, rank);
        EXPECT_EQ(share.failure, "");
        EXPECT_EQ(share.device.name, test_device().info.name);
        EXPECT_GT(share.passes, 0U);
        sum += share.passes;
    }
    EXPECT_EQ(sum, passes);
}

TEST(JointRender, OthersDoWhatARankLost) {
    for (const std::vector<std::string>& faults :
         std::vector<std::vector<std::string>>{{"lost:100", ""}, {"", "none", "launch:61"}}) {
        // On a busy machine the others may have done all before the fault: then once more.
        bool as_planned = false;
        for (int attempt = 0; attempt < most_attempts && !as_planned; ++attempt) {
            const RenderOutcome outcome = render(faults);
            expect_same_image(outcome.sums, expected());
            EXPECT_EQ(outcome.statistics.passes, passes);
            ASSERT_EQ(outcome.shares.size(), faults.size());
            as_planned = true;
            for (std::size_t rank = 0; rank < faults.size(); ++rank)
                as_planned &= outcome.shares[rank].failure.empty() == faults[rank].empty();
        }
        EXPECT_TRUE(as_planned);
    }
    const RenderOutcome none = render({"lost:100", "lost:110"});
    EXPECT_GT(none.statistics.passes, 0U);
    EXPECT_LT(none.statistics.passes, passes);
    EXPECT_EQ(none.sums.passes.count(), none.statistics.passes);
}

/// Sums that are reduced on the way hold the passes that they say, and another render goes on from them.
TEST(JointRender, SumsOnTheWayAreWhole) {
    std::optional<RenderSums> partial;
    // On a busy machine all may be done before rank 0 comes to ask: then once more.
    for (int attempt = 0; attempt < most_attempts && !partial; ++attempt) {
        bool requested = false;
        const RenderOutcome outcome = render({"", "", ""}, [&](PassRenderer& joint, Communicator& rank, std::uint64_t) {
            if (rank.rank() != 0)
                return true;
            if (!std::exchange(requested, true))
                joint.request_sums();
            if (std::optional<RenderSums> sums = joint.requested_sums()) {
                EXPECT_TRUE(holds_passes(sums->film, sums->passes.count())) << sums->passes.text();
                if (!sums->passes.empty() && sums->passes.count() < passes)
                    partial = std::move(sums);
                requested = false;
            }
            return true;
        });
        expect_same_image(outcome.sums, expected());
    }
    ASSERT_TRUE(partial);
    const std::unique_ptr<Team> one = team();
    one->resume(*partial, one->initial_radii());
    one->render({passes, {}}, [](std::uint64_t) { return true; });
    expect_same_image(one->outcome().sums, expected());
}

TEST(JointRender, AnyRankEndsItForAll) {
    for (const int who : {0, 2}) {
        const RenderOutcome outcome = render({"", "", ""}, [&](PassRenderer&, Communicator& rank, std::uint64_t done) {
            return rank.rank() != who || done < 5;
        });
        EXPECT_EQ(outcome.stopped_elsewhere, who != 0) << who;
        EXPECT_GE(outcome.statistics.passes, 1U) << who;
        EXPECT_LT(outcome.statistics.passes, passes) << who;
        EXPECT_TRUE(holds_passes(outcome.sums.film, outcome.sums.passes.count())) << who;
    }
}

TEST(JointRender, RanksGoOnFromSums) {
    const RenderSums earlier = alone({7, {}, 11});
    RenderOutcome outcome;
    ThreadRanks ranks(2);
    ranks.run([&](Communicator& rank) {
        const bool first = rank.rank() == 0;
        std::unique_ptr<Team> own = team();
        if (first)
            own->resume(earlier, own->initial_radii());
        JointRender joint(rank, options(), std::move(own), "", first ? earlier.passes : PassRanges());
        joint.render({passes, {}}, [](std::uint64_t) { return true; });
        RenderOutcome part = joint.outcome();
        if (first)
            outcome = std::move(part);
    });
    EXPECT_EQ(outcome.sums.passes, PassRanges(0, passes));
    EXPECT_EQ(outcome.sums.rays.photon, expected().rays.photon);
    expect_same_image(outcome.sums, expected());
}

} // namespace
} // namespace tristim::test
