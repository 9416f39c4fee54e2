// `mpirun tristim render`: several processes, and network namespaces in place of machines. What ranks do is tested
// without processes in joint_render_test.cpp.

#include "child_process.h"
#include "image/read_image.h"
#include "mpi/communicator.h"
#include "render/checkpoint.h"
#include "scene_folder.h"
#include "test_scenes.h"

#include <OpenImageIO/imageio.h>
#include <filesystem>
#include <future>

namespace tristim::test {
namespace {

constexpr const char* scene = TRISTIM_SOURCE_DIR "/meshes/dispersion/scene.pbrt";

/// Open MPI refuses root, more ranks than cores, and in containers some ways of sharing memory, unless told otherwise.
/// And it does not free all that it allocates.
const std::map<std::string, std::string> environment{{"OMPI_ALLOW_RUN_AS_ROOT", "1"},
                                                     {"OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"},
                                                     {"OMPI_MCA_rmaps_base_oversubscribe", "1"},
                                                     {"OMPI_MCA_hwloc_base_binding_policy", "none"},
                                                     {"OMPI_MCA_btl_vader_single_copy_mechanism", "none"},
                                                     {"LSAN_OPTIONS", "detect_leaks=0"}};

std::string find_program(const std::string& name) {
    const char* path = std::getenv("PATH");
    std::istringstream folders(path != nullptr ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');) {
        if (::access((folder + "/" + name).c_str(), X_OK) == 0)
            return folder + "/" + name;
    }
    return {};
}

class Mpirun : public testing::Test {
  protected:
    void SetUp() override {
        if (!built_with_mpi() || mpirun.empty())
            GTEST_SKIP() << "tristim was built without MPI, or there is no mpirun";
    }

    std::vector<std::string> render(int passes, const std::string& image) const {
        return {"render", scene,      "--resolution",         "16x12",     "--photons",
                "2048",   "--passes", std::to_string(passes), "--outfile", folder.path(image)};
    }

    ChildResult run(const std::vector<std::string>& launch, const std::vector<std::string>& command,
                    const ChildLimits& limits = {}) const {
        std::vector<std::string> words = launch;
        words.emplace_back(TRISTIM_COMMAND);
        words.insert(words.end(), command.begin(), command.end());
        return run_program(mpirun, words, environment, limits);
    }

    void expect_same_image(const std::string& a, const std::string& b) const {
        EXPECT_EQ(read_exr(folder.path(a)).xyz, read_exr(folder.path(b)).xyz) << a << ", " << b;
    }

    /// Passes in a checkpoint or an image.
    int passes_in(const std::string& file) const {
        const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(folder.path(file));
        return input ? input->spec().get_int_attribute("tristim:passes", -1) : -1;
    }

    SceneFolder folder;
    const std::string mpirun = find_program("mpirun");
};

template <typename... Words>
std::vector<std::string> with(std::vector<std::string> all, const Words&... more) {
    (all.emplace_back(more), ...);
    return all;
}

int count(const std::string& text, const std::string& word) {
    int found = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
        ++found;
    return found;
}

/// The processes of the command that have this among their arguments.
std::vector<::pid_t> ranks_with(const std::string& argument) {
    std::vector<::pid_t> found;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
        std::ifstream file(entry.path() / "cmdline");
        const std::string words((std::istreambuf_iterator<char>(file)), {});
        if (words.starts_with(std::string(TRISTIM_COMMAND) + '\0') && words.find(argument) != std::string::npos)
            found.push_back(std::stoi(entry.path().filename()));
    }
    return found;
}

TEST_F(Mpirun, RanksRenderTheImageOfOneProcess) {
    ASSERT_EQ(run_tristim(render(100, "one.exr")).exit_code, 0);
    const ChildResult three =
        run({"-n", "3"}, with(render(100, "three.exr"), "--checkpoint", folder.path("c.exr"), "--every", "0.001"));
    EXPECT_EQ(three.exit_code, 0) << three.standard_error;
    EXPECT_EQ(count(three.standard_error, "pass 100/100"), 1) << three.standard_error;
    EXPECT_EQ(count(three.standard_error, "100 passes on 3 ranks: 3 × "), 1) << three.standard_error;
    expect_same_image("one.exr", "three.exr");
    EXPECT_EQ(passes_in("three.exr"), 100);
}

TEST_F(Mpirun, ErrorsAreToldOnce) {
    const ChildResult usage = run({"-n", "2"}, {"render", scene, "--nonsense"});
    EXPECT_EQ(usage.exit_code, 2);
    EXPECT_EQ(count(usage.standard_error, "tristim: "), 1) << usage.standard_error;
    if (!long_tests())
        return;
    const ChildResult missing = run({"-n", "3"}, {"render", "missing.pbrt"});
    EXPECT_EQ(missing.exit_code, 1);
    EXPECT_EQ(count(missing.standard_error, "tristim: "), 1) << missing.standard_error;
    EXPECT_NE(missing.standard_error.find("missing.pbrt"), std::string::npos);
    EXPECT_EQ(count(missing.standard_error, "rank "), 0) << missing.standard_error;

    const auto two = [&](const std::string& option, const std::string& value) {
        const std::vector<std::string> command = with(render(60, "a.exr"), "--quiet");
        std::vector<std::string> words{"-n", "1", TRISTIM_COMMAND};
        words.insert(words.end(), command.begin(), command.end());
        for (const char* word : {":", "-n", "1", TRISTIM_COMMAND})
            words.emplace_back(word);
        words.insert(words.end(), command.begin(), command.end());
        return run_program(mpirun, with(words, option, value), environment);
    };
    const ChildResult other = two("--seed", "5");
    EXPECT_EQ(other.exit_code, 1);
    EXPECT_EQ(count(other.standard_error, "rank 1 would render another image than rank 0: seed"), 1)
        << other.standard_error;
    const ChildResult usage_of_one = two("--every", "often"); // the other one must not wait for it
    EXPECT_NE(usage_of_one.exit_code, 0);
    EXPECT_EQ(count(usage_of_one.standard_error, "tristim: rank 1: Could not convert: --every = often"), 1)
        << usage_of_one.standard_error;
    const ChildResult no_device = two("--device", "nonesuch");
    EXPECT_EQ(no_device.exit_code, 1);
    EXPECT_EQ(count(no_device.standard_error, "tristim: rank 1: device 'nonesuch' not found"), 1)
        << no_device.standard_error;
}

/// Without MPI each rank would render everything.
TEST(WithoutMpi, SeveralRanksAreRefused) {
    const auto joined = [](const std::map<std::string, std::string>& launcher) {
        return run_program(WITHOUT_MPI, {}, launcher);
    };
    for (const auto& [launcher, words] : std::map<std::map<std::string, std::string>, std::string>{
             {{{"OMPI_COMM_WORLD_SIZE", "2"}},
              "Open MPI's mpirun started 2 ranks, each of which would render everything"},
             {{{"PMI_SIZE", "4"}}, "a launcher that speaks PMI started 4 ranks, "},
             {{{"PMIX_RANK", "0"}, {"SLURM_STEP_NUM_TASKS", "3"}}, "a launcher that speaks PMIx started 3 ranks, "}}) {
        const ChildResult refused = joined(launcher);
        EXPECT_EQ(refused.exit_code, 1) << words;
        EXPECT_EQ(refused.standard_output.rfind(words, 0), 0U) << refused.standard_output;
    }
    for (const std::map<std::string, std::string>& alone :
         {std::map<std::string, std::string>{}, {{"OMPI_COMM_WORLD_SIZE", "1"}}, {{"PMIX_RANK", "0"}}})
        EXPECT_EQ(joined(alone).exit_code, 0);
}

/// SIGTERM to one of them, as a scheduler may send it; what mpirun is sent it passes on to all.
TEST_F(Mpirun, ASignalEndsAllRanksAndSaves) {
    if (!long_tests())
        GTEST_SKIP() << "set TRISTIM_LONG_TESTS=1";
    const std::vector<std::string> command =
        with(render(1000000, "image.exr"), "--checkpoint", folder.path("c.exr"), "--every", "2");
    std::future<ChildResult> running = std::async(std::launch::async, [&] { return run({"-n", "3"}, command); });
    while (!std::filesystem::exists(folder.path("c.exr"))) // passes are under way then
        ASSERT_EQ(running.wait_for(std::chrono::milliseconds(50)), std::future_status::timeout) << "ended too early";
    ::kill(ranks_with(folder.path("c.exr")).back(), SIGTERM); // any one rank
    const ChildResult ended = running.get();
    EXPECT_EQ(ended.exit_code, 3) << ended.standard_error;
    EXPECT_EQ(count(ended.standard_error, "interrupted: "), 1) << ended.standard_error;
    EXPECT_GT(passes_in("image.exr"), 0);
    // The checkpoint is as good as the image; some of its passes may follow others that were not done yet.
    const PassRanges saved = read_checkpoint(folder.path("c.exr")).sums.passes;
    EXPECT_EQ(saved.count(), static_cast<std::uint64_t>(passes_in("image.exr")));
    const int all = static_cast<int>(saved.ranges().back().end) + 100;
    ASSERT_EQ(run_tristim(with(render(all, "on.exr"), "--resume", folder.path("c.exr"))).exit_code, 0);
    ASSERT_EQ(run_tristim(render(all, "one.exr")).exit_code, 0);
    expect_same_image("one.exr", "on.exr");
}

TEST_F(Mpirun, AKilledRankLosesAnIntervalAtMost) {
    if (!long_tests())
        GTEST_SKIP() << "set TRISTIM_LONG_TESTS=1";
    constexpr int passes = 6000;
    constexpr std::chrono::milliseconds every{500};
    const std::string file = folder.path("c.exr");
    ASSERT_EQ(run_tristim(render(passes, "one.exr")).exit_code, 0);
    const std::vector<std::string> command = with(render(passes, "killed.exr"), "--checkpoint", file, "--every", "0.5");
    std::future<ChildResult> running = std::async(std::launch::async, [&] { return run({"-n", "3"}, command); });
    using Time = std::filesystem::file_time_type;
    std::set<Time> times; // of checkpoints
    while (times.size() < 3) {
        std::error_code none_yet;
        const Time time = std::filesystem::last_write_time(file, none_yet);
        if (!none_yet)
            times.insert(time);
        ASSERT_EQ(running.wait_for(std::chrono::milliseconds(10)), std::future_status::timeout) << "ended too early";
    }
    // Let most of an interval go by, so that there is something to lose.
    std::this_thread::sleep_for(every / 2);
    const Time killed = Time::clock::now();
    ::kill(ranks_with(file).back(), SIGKILL);
    EXPECT_NE(running.get().exit_code, 0);
    EXPECT_FALSE(std::filesystem::exists(folder.path("killed.exr")));
    // One interval, and another for saving on a machine that is as loaded as this one.
    EXPECT_LT(killed - std::filesystem::last_write_time(file), 2 * every);

    const ChildResult two = run({"-n", "2"}, with(render(passes, "on.exr"), "--resume", file));
    ASSERT_EQ(two.exit_code, 0) << two.standard_error;
    expect_same_image("one.exr", "on.exr");
    EXPECT_EQ(passes_in("on.exr"), passes);
}

/// Ranks on machines of their own, so far as one machine can show them: in network namespaces that a bridge joins.
TEST_F(Mpirun, HostsRenderTheImageOfOneProcess) {
    if (!long_tests())
        GTEST_SKIP() << "set TRISTIM_LONG_TESTS=1";
    const std::string script = TRISTIM_SOURCE_DIR "/tests/mpi/hosts";
    const ChildResult made = run_program(script, {"up", "3"});
    if (made.exit_code != 0)
        GTEST_SKIP() << "this machine allows no network namespaces: " << made.standard_error;
    ASSERT_EQ(run_tristim(render(100, "one.exr")).exit_code, 0);
    std::vector<std::string> launch{"-n", "3"};
    std::istringstream options(made.standard_output);
    for (std::string word; options >> word;)
        launch.push_back(word);
    const ChildResult three =
        run(launch, with(render(100, "three.exr"), "--checkpoint", folder.path("c.exr"), "--every", "0.001"));
    EXPECT_EQ(run_program(script, {"down", "3"}).exit_code, 0);
    ASSERT_EQ(three.exit_code, 0) << three.standard_error;
    EXPECT_EQ(count(three.standard_error, "100 passes on 3 ranks"), 1) << three.standard_error;
    expect_same_image("one.exr", "three.exr");
}

} // namespace
} // namespace tristim::test
