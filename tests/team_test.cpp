// Renders on several devices, and on devices that fail: host/render/team.h. The devices are one, opened several times;
// tests/backends_test.cpp has different ones.

#include "all_take_part.h"
#include "child_process.h"
#include "render/team.h"
#include "scene_folder.h"
#include "test_scenes.h"

#include <OpenImageIO/imageio.h>
#include <cstring>
#include <memory>
#include <new>

namespace tristim::test {
namespace {

using Bits = std::vector<std::array<float, 3>>;

constexpr std::uint64_t passes = 16;
constexpr const char* scene_path = TRISTIM_SOURCE_DIR "/meshes/dispersion/scene.pbrt";

RenderOptions options() {
    RenderOptions options = small_render("tristimulus:2", 16, 12, 2048, 0.1, 16);
    options.radius.reset();
    return options;
}

/// The test device, opened anew, with what is to fail on each ("" if nothing).
std::vector<Device> devices(const std::vector<std::string>& faults) {
    std::vector<Device> opened;
    for (const std::string& fault : faults) {
        opened.push_back(open_device(std::to_string(test_device().info.index)));
        if (!fault.empty())
            opened.back().faults = std::make_shared<FaultPlan>(fault);
    }
    return opened;
}

RenderOutcome render(const std::vector<std::string>& faults) {
    Team team(load_scene(scene_path), options(), devices(faults));
    team.render({passes, {}}, [](std::uint64_t) { return true; });
    return team.outcome();
}

Bits bits(const RenderOutcome& outcome) {
    return developed(outcome.sums, options()).xyz;
}

/// The image of the first passes by one renderer.
Bits alone(std::uint64_t count) {
    Renderer renderer(load_scene(scene_path), options(), test_device());
    for (std::uint32_t pass = 0; pass < count; ++pass)
        renderer.render_pass(pass);
    return renderer.film().xyz;
}

void expect_words(const std::string& text, const std::vector<std::string>& words) {
    for (const std::string& word : words)
        EXPECT_NE(text.find(word), std::string::npos) << text;
}

bool same(const Bits& a, const Bits& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
}

TEST(Team, SharingDoesNotShow) {
    const Bits expected = alone(passes);
    for (const std::size_t count : {1, 3}) {
        const RenderOutcome outcome =
            render_until_all_take_part([count] { return render(std::vector<std::string>(count)); });
        EXPECT_TRUE(same(bits(outcome), expected)) << count << " devices";
        EXPECT_EQ(outcome.statistics.passes, passes);
        EXPECT_EQ(outcome.statistics.photons_emitted, passes * 2048);
        ASSERT_EQ(outcome.shares.size(), count);
        std::uint64_t sum = 0;
        for (const DeviceShare& share : outcome.shares) {
            EXPECT_GT(share.passes, 0U);
            EXPECT_EQ(share.failure, "");
            sum += share.passes;
        }
        EXPECT_EQ(sum, passes);
        EXPECT_GE(outcome.sums.rays.camera, passes * 16 * 12);
    }
}

TEST(Team, OthersDoWhatAFailedDeviceLost) {
    const Bits expected = alone(passes);
    // Some launches are those of the pilot pass, which has its device left out from the start; others come in passes.
    for (const char* fault : {"build:2", "allocate:9", "launch:3", "launch:25", "lost:26", "launch:40", "lost:45"}) {
        const RenderOutcome outcome = render({"", fault});
        EXPECT_TRUE(same(bits(outcome), expected)) << fault;
        EXPECT_EQ(outcome.statistics.passes, passes) << fault;
        EXPECT_EQ(outcome.shares[0].failure, "") << fault;
        EXPECT_NE(outcome.shares[1].failure, "") << fault;
    }
}

TEST(Team, OfTheOnlyDeviceThePassesDoneAreKept) {
    for (const char* fault : {"launch:120", "lost:120"}) {
        const RenderOutcome outcome = render({fault});
        EXPECT_NE(outcome.shares[0].failure, "") << fault;
        EXPECT_GE(outcome.statistics.passes, 1U) << fault;
        EXPECT_LT(outcome.statistics.passes, passes) << fault;
        EXPECT_TRUE(same(bits(outcome), alone(outcome.statistics.passes))) << fault;
    }
}

/// Passes rendered by several teams, each resuming what those before it have done, on devices that fail as well: the
/// image of one, and what was resumed is never lost.
TEST(Team, GoesOnFromSums) {
    const Bits expected = alone(passes);
    const Scene scene = load_scene(scene_path);
    RenderSums sums;
    std::vector<float> radii;
    for (const auto& [first, count, fault] : std::vector<std::tuple<std::uint32_t, std::uint64_t, const char*>>{
             {4, 3, ""}, {9, 9, "lost:61"}, {0, 16, ""}}) {
        Team team(scene, options(), devices({fault, ""}));
        if (!radii.empty())
            team.resume(sums, radii);
        else
            radii = team.initial_radii();
        team.render({count, {}, first}, [](std::uint64_t) { return true; });
        const PassRanges before = sums.passes;
        const RenderOutcome outcome = team.outcome();
        sums = outcome.sums;
        EXPECT_TRUE(passes_to_do({count, {}, first}, sums.passes).empty()) << sums.passes.text();
        EXPECT_EQ(outcome.statistics.passes, sums.passes.count());
        EXPECT_EQ(outcome.shares[0].passes + outcome.shares[1].passes + before.count(), sums.passes.count());
    }
    EXPECT_EQ(sums.passes.text(), "0:18");
}

TEST(Team, GivesOutSumsWhileItRenders) {
    Team team(load_scene(scene_path), options(), devices({"", ""}));
    team.request_sums();
    RenderSums last;
    int given = 0;
    team.render({}, [&](std::uint64_t) {
        if (const auto sums = team.requested_sums()) {
            EXPECT_TRUE(holds_passes(sums->film, sums->passes.count()));
            EXPECT_EQ(sums->passes.common(last.passes), last.passes);
            last = *sums;
            ++given;
            team.request_sums();
        }
        return given < 3;
    });
    EXPECT_GT(last.passes.count(), 2U);
    const RenderSums all = team.outcome().sums;
    EXPECT_EQ(all.passes.common(last.passes), last.passes);
    EXPECT_EQ(all.passes, PassRanges(0, static_cast<std::uint32_t>(all.passes.count())));
}

/// Such as for want of memory. The devices' threads end first, and what they have done can still be had.
TEST(Team, WhatGoOnThrowsComesOut) {
    Team team(load_scene(scene_path), options(), devices({"", ""}));
    EXPECT_THROW(team.render({1000000, {}}, [](std::uint64_t) -> bool { throw std::bad_alloc(); }), std::bad_alloc);
    EXPECT_TRUE(holds_passes(team.outcome().sums.film, team.outcome().statistics.passes));
}

/// Radii that follow each pixel's statistics are in the sums, so that passes can go on in order, and in no other.
TEST(Team, StatisticsRadiiGoOn) {
    RenderOptions statistics = options();
    statistics.statistics_radius = true;
    const Scene scene = load_scene(scene_path);
    const auto render_from = [&](const RenderSums& sums, const std::vector<float>& radii, const RenderBudget& limits) {
        Team team(scene, statistics, devices({""}));
        if (!radii.empty())
            team.resume(sums, radii);
        team.render(limits, [](std::uint64_t) { return true; });
        return std::pair(team.outcome().sums, team.initial_radii());
    };
    const auto [whole, radii] = render_from({}, {}, {9, {}});
    const RenderSums part = render_from({}, {}, {4, {}}).first;
    const RenderSums resumed = render_from(part, radii, {9, {}}).first;
    ASSERT_EQ(resumed.film.size(), whole.film.size());
    EXPECT_EQ(std::memcmp(resumed.film.data(), whole.film.data(), whole.film.size() * sizeof(FilmPixel)), 0);
    EXPECT_EQ(resumed.rays.photon, whole.rays.photon);
    EXPECT_EQ(resumed.photons_stored, whole.photons_stored);
    expect_words(error_of([&] { render_from(part, radii, {3, {}, 5}); }), {"--radius statistics", "5:8", "0:4"});
    expect_words(error_of([&] { render_from({}, {}, {3, {}, 5}); }), {"--radius statistics", "5:8", "none"});
}

TEST(Team, WithoutAnyDeviceItSaysWhy) {
    expect_words(error_of([] {
                     Team(load_scene(scene_path), options(), devices({"allocate:1", "build:1"}));
                 }),
                 {"out of device memory"});
    RenderOptions statistics = options();
    statistics.statistics_radius = true;
    expect_words(error_of([&] {
                     Team(load_scene(scene_path), statistics, devices({"", ""}));
                 }),
                 {"--radius statistics", "one --device"});
}

TEST(Team, TheCommandSavesAnImageAndFails) {
    const SceneFolder folder;
    const std::string path = folder.path("a.exr");
    const auto render_with = [&](const std::string& fault, const std::string& device) {
        return run_tristim({"render", scene_path, "--resolution", "16x12", "--photons", "2048", "--passes", "16",
                            "--device", device, "--outfile", path},
                           {{"TRISTIM_FAULT", fault}});
    };
    const ChildResult lost = render_with("lost:120", "0");
    EXPECT_EQ(lost.exit_code, 1);
    expect_words(lost.standard_error, {"error: device", "failed after", "CL_DEVICE_NOT_AVAILABLE"});
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path);
    ASSERT_TRUE(input) << OIIO::geterror();
    EXPECT_GE(input->spec().get_int_attribute("tristim:passes"), 1);
    EXPECT_LT(input->spec().get_int_attribute("tristim:passes"), 16);

    const ChildResult shared = render_with("lost:120:1", "0,0");
    EXPECT_EQ(shared.exit_code, 0) << shared.standard_error;
    expect_words(shared.standard_error, {"warning: device", "16 passes on", "CL_DEVICE_NOT_AVAILABLE"});

    EXPECT_EQ(render_with("", "0,").exit_code, 1);
    EXPECT_EQ(render_with("nonsense", "0").exit_code, 1);
    const ChildResult one = run_tristim({"bench-pass", scene_path, "--device", "0,0"});
    EXPECT_EQ(one.exit_code, 1);
    expect_words(one.standard_error, {"runs on one device", "0,0"});
}

} // namespace
} // namespace tristim::test
