// tristim reference: a file is begun, continued and finished; what cannot be continued stays as it was.
#include "bench/reference.h"
#include "child_process.h"
#include "image_statistics.h"
#include "scene_folder.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

namespace tristim::test::reference_command_test {
namespace {

constexpr const char* small_scene =
    "Camera \"perspective\"\n"
    "Film \"rgb\" \"integer xresolution\" [ 16 ] \"integer yresolution\" [ 8 ]\n"
    "Integrator \"sppm\" \"integer photonsperiteration\" [ 256 ] \"float radius\" [ 0.5 ]\n"
    "WorldBegin\n"
    "LightSource \"point\" \"point3 from\" [ 0 1 0 ] \"spectrum I\" \"stdillum-A\"\n"
    "Material \"diffuse\" \"rgb reflectance\" [ 0.7 0.3 0.1 ]\n"
    "Shape \"bilinearmesh\" \"point3 P\" [ -20 -20 5  20 -20 5  -20 20 5  20 20 5 ]\n";

class ReferenceCommand : public testing::Test {
  protected:
    ReferenceCommand() : scene(folder.write("scene.pbrt", small_scene)), out(folder.path("r.exr")) {}

    ChildResult reference(const std::vector<std::string>& more, const ChildLimits& limits = {}) const {
        std::vector<std::string> arguments{"reference", scene, "--out", out};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_tristim(arguments, {}, limits);
    }

    /// Expects one line on stderr that holds the words, and the output file as it was.
    void expect_failure(const std::vector<std::string>& more, const std::string& words,
                        const ChildLimits& limits = {}) const {
        const std::string before = read_text(out);
        const ChildResult result = reference(more, limits);
        SCOPED_TRACE(fmt::format("{}", fmt::join(more, " ")));
        EXPECT_TRUE(result.exit_code == 1 || result.exit_code == 2) << result.exit_code;
        expect_message(result.standard_error.substr(0, result.standard_error.find('\n')), "tristim: ", words);
        EXPECT_EQ(std::count(result.standard_error.begin(), result.standard_error.end(), '\n'), 1)
            << result.standard_error;
        EXPECT_EQ(read_text(out), before);
        std::size_t files = 0;
        for ([[maybe_unused]] const auto& file : std::filesystem::directory_iterator(folder.path("")))
            ++files;
        EXPECT_EQ(files, before.empty() ? 1U : 2U) << "a file was left behind";
    }

    SceneFolder folder;
    std::string scene;
    std::string out;
};

TEST_F(ReferenceCommand, BeginsAndContinues) {
    const ChildResult begun = reference({"--time=0.5"});
    ASSERT_EQ(begun.exit_code, 0) << begun.standard_error;
    EXPECT_NE(begun.standard_error.find("error "), std::string::npos) << begun.standard_error;
    const Reference first = read_reference(out);
    EXPECT_EQ(first.method, "spectral:400");
    EXPECT_EQ(first.seed, reference_seed);
    EXPECT_EQ(first.scene, scene);
    EXPECT_EQ(first.photons, 256 * first.passes);
    EXPECT_GE(first.seconds, 0.5);
    EXPECT_GE(first.passes, 2U);

    const double more = first.seconds + 0.1;
    const ChildResult continued = reference({fmt::format("--time={}", more)});
    ASSERT_EQ(continued.exit_code, 0) << continued.standard_error;
    EXPECT_NE(continued.standard_error.find(fmt::format("continuing {}: {} passes", out, first.passes)),
              std::string::npos)
        << continued.standard_error;
    const Reference second = read_reference(out);
    EXPECT_GT(second.passes, first.passes);
    EXPECT_GE(second.seconds, more);
    EXPECT_EQ(second.photons, 256 * second.passes);

    const std::string bytes = read_text(out);
    const ChildResult enough = reference({"--time=0.5"});
    EXPECT_EQ(enough.exit_code, 0);
    EXPECT_NE(enough.standard_error.find("nothing to do"), std::string::npos) << enough.standard_error;
    EXPECT_EQ(read_text(out), bytes);

    const ChildResult comparison = run_tristim({"compare", out, out});
    EXPECT_EQ(comparison.exit_code, 0) << comparison.standard_error;
    const ChildResult silent = reference({fmt::format("--time={}", second.seconds + 0.1), "--quiet"});
    EXPECT_EQ(silent.standard_error, "");
}

TEST_F(ReferenceCommand, RefusesToContinueSomethingElse) {
    ASSERT_EQ(reference({"--time=0.01", "--quiet"}).exit_code, 0);
    expect_failure({"--time=9", "--resolution=8x8"}, "its resolution is 16x8, not 8x8");
    expect_failure({"--time=9", "--seed=4"}, "its seed is 1380271665, not 4");
    std::string other = small_scene;
    folder.write("scene.pbrt", other.replace(other.find("0.7 0.3"), 7, "0.7 0.4"));
    expect_failure({"--time=9"}, "it shows another scene");
}

TEST_F(ReferenceCommand, RefusesBadInput) {
    expect_failure({}, "--time is required");
    for (const char* time : {"-1", "inf"})
        expect_failure({std::string("--time=") + time}, "--time must be a positive number of seconds");
    expect_failure({"--time=soon"}, "soon");
    expect_failure({"--time=1", "--radius=statistics"}, "--radius global");
    expect_failure({"--time=1", "--region=0,0,99,8"}, "16x8");
    for (const std::string& other : {folder.path("missing/r.exr"), scene + "/r.exr"}) {
        const ChildResult result = run_tristim({"reference", scene, "--time=1", "--out", other});
        EXPECT_EQ(result.exit_code, 1);
        expect_message(result.standard_error.substr(0, result.standard_error.find('\n')),
                       "tristim: cannot write \"" + other + "\"", "");
    }
    const ChildResult png = run_tristim({"reference", scene, "--time=1", "--out", folder.path("r.png")});
    EXPECT_NE(png.standard_error.find("a reference is an .exr file"), std::string::npos) << png.standard_error;

    folder.write("r.exr", "what was there");
    expect_failure({"--time=1"}, "cannot read");
    ASSERT_EQ(run_tristim({"render", scene, "--outfile", out, "--passes=1", "--quiet"}).exit_code, 0);
    expect_failure({"--time=1"}, "not written by tristim reference");
}

/// The largest file of the child is 4 MiB: more than PoCL's own temporary files, less than the reference.
TEST_F(ReferenceCommand, FullDiskLeavesWhatWasThere) {
    ASSERT_EQ(reference({"--time=0.01", "--resolution=300x300", "--method=rgb", "--quiet"}).exit_code, 0);
    const std::string more = fmt::format("--time={}", read_reference(out).seconds + 0.1);
    expect_failure({more, "--resolution=300x300", "--method=rgb", "--quiet"}, "cannot write",
                   ChildLimits{4U << 20U, {}, {}});
}

TEST_F(ReferenceCommand, CtrlCWritesWhatIsDone) {
    const ChildResult result = reference({"--time=1000"}, ChildLimits{{}, {}, std::chrono::milliseconds(300)});
    EXPECT_EQ(result.exit_code, 0) << result.standard_error;
    EXPECT_NE(result.standard_error.find("interrupted: "), std::string::npos) << result.standard_error;
    const Reference written = read_reference(out);
    EXPECT_GE(written.passes, 1U);
    EXPECT_GT(written.seconds, 0.0);
}

/// Whatever shapes a pass must stay as it was begun.
TEST(ReferenceRender, RefusesOtherOptions) {
    const SceneFolder folder;
    const Scene scene = folder.load(small_scene);
    RenderOptions options = options_from_scene(scene.settings);
    options.method = parse_method("tristimulus:1");
    const std::string path = folder.path("r.exr");
    const auto render = [&](const Scene& of, const RenderOptions& with) {
        render_reference(of, "scene.pbrt", with, test_device(), 1e9, path,
                         [](std::uint64_t done, double) { return done < 2; });
    };
    render(scene, options);
    const std::string before = read_text(path);
    const auto expect_difference = [&](const std::string& words, const std::function<void(RenderOptions&)>& change) {
        RenderOptions other = options;
        change(other);
        EXPECT_EQ(error_of([&] { render(scene, other); }), "cannot continue \"" + path + "\": " + words);
    };
    expect_difference("its resolution is 16x8, not 8x8", [](RenderOptions& o) {
        o.width = 8;
        o.region = {0, 0, 8, 8};
    });
    expect_difference("its region is 0,0,16,8, not 0,0,4,4", [](RenderOptions& o) { o.region = {0, 0, 4, 4}; });
    expect_difference("its maximum depth is 5, not 3", [](RenderOptions& o) { o.max_depth = 3; });
    expect_difference("its method is tristimulus:1, not rgb", [](RenderOptions& o) { o.method = parse_method("rgb"); });
    expect_difference("its seed is 0, not 4", [](RenderOptions& o) { o.seed = 4; });
    expect_difference("its sequence is stratified, not random", [](RenderOptions& o) { o.random_sequence = true; });
    expect_difference("its photons per pass is 256, not 512", [](RenderOptions& o) { o.photons_per_pass = 512; });
    expect_difference("its initial radius is 0.5, not auto", [](RenderOptions& o) { o.radius.reset(); });
    expect_difference("its radius factor is 1, not 0.5", [](RenderOptions& o) { o.radius_factor = 0.5; });
    expect_difference("its alpha is 0.6666666666666666, not 0.5", [](RenderOptions& o) { o.alpha = 0.5; });
    expect_difference("its direct is sample, not photons", [](RenderOptions& o) { o.direct_photons = true; });
    expect_difference("its photon roughness is 0.1, not 0.2", [](RenderOptions& o) { o.photon_roughness = 0.2; });
    expect_difference("its math is precise, not fast", [](RenderOptions& o) { o.fast_math = true; });
    Scene other = scene;
    other.camera.fov_degrees = 80.0;
    EXPECT_EQ(error_of([&] { render(other, options); }), "cannot continue \"" + path + "\": its camera is another one");
    EXPECT_EQ(read_text(path), before);
}

/// Rendered in pieces, with the halves interrupted anywhere, a reference has the same passes as in one go.
TEST(ReferenceRender, PiecesMakeTheWhole) {
    const SceneFolder folder;
    const Scene scene = folder.load(small_scene);
    RenderOptions options = options_from_scene(scene.settings);
    options.method = parse_method("tristimulus:1");
    options.seed = 5;
    const auto render_until = [&](const std::string& name, std::uint64_t passes) {
        return render_reference(scene, "scene.pbrt", options, test_device(), 1e9, folder.path(name),
                                [passes](std::uint64_t done, double) { return done < passes; });
    };
    const Reference whole = render_until("whole.exr", 128);
    for (const std::uint64_t passes : {1U, 3U, 30U, 75U, 128U})
        render_until("pieces.exr", passes);
    const Reference pieces = read_reference(folder.path("pieces.exr"));
    EXPECT_EQ(pieces.passes, 128U);
    EXPECT_EQ(whole.passes, 128U);
    for (std::size_t h = 0; h < 2; ++h) {
        EXPECT_EQ(pieces.halves[h].passes, 64U);
        EXPECT_EQ(whole.halves[h].passes, 64U);
    }
    EXPECT_GT(pieces.snapshot_passes, 0U);
    EXPECT_EQ(whole.snapshot_passes, 8U);
    for (std::size_t i = 0; i < whole.image.xyz.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double value = whole.image.xyz[i][c];
            // Five merges, each of which rounds halves and whole to float.
            const double rounding = 10.0 * 6e-8 * std::abs(value);
            EXPECT_NEAR(pieces.image.xyz[i][c], value, rounding);
            const double halves = 0.5 * (static_cast<double>(pieces.halves[0].xyz[i][c]) + pieces.halves[1].xyz[i][c]);
            EXPECT_NEAR(halves, value, rounding);
            // A variance of the mean far below the mean's square loses digits with it: float's 24 bits of n times it.
            const double variance = whole.variance[i][c];
            EXPECT_NEAR(pieces.variance[i][c], variance, 1e-4 * variance + 2.0 * 128.0 * 6e-8 * 6e-8 * value * value);
        }
    }
    EXPECT_NE(whole.halves[0].xyz, whole.halves[1].xyz) << "the halves need seeds of their own";
}

/// The image is the mean that render makes of the same passes.
TEST(ReferenceRender, FirstHalfIsAnOrdinaryRender) {
    const SceneFolder folder;
    const Scene scene = folder.load(small_scene); // direct light alone: the search radius plays no part
    RenderOptions options = options_from_scene(scene.settings);
    options.method = parse_method("tristimulus:1");
    const Reference reference = render_reference(scene, "scene.pbrt", options, test_device(), 1e9, folder.path("r.exr"),
                                                 [](std::uint64_t done, double) { return done < 16; });
    for (std::size_t h = 0; h < 2; ++h) {
        options.seed = half_seeds(reference.seed)[h];
        const TestImage image = render_image(scene, options, 8);
        for (std::size_t i = 0; i < image.xyz.size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_EQ(reference.halves[h].xyz[i][c], static_cast<float>(image.xyz[i][c]));
        }
    }
}

TEST(ReferenceRender, WritesNowAndThen) {
    const SceneFolder folder;
    const Scene scene = folder.load(small_scene);
    RenderOptions options = options_from_scene(scene.settings);
    options.method = parse_method("tristimulus:1");
    const std::string path = folder.path("r.exr");
    std::vector<std::uint64_t> seen;
    const auto progress = [&](std::uint64_t done, double) {
        seen.push_back(std::filesystem::exists(path) ? read_reference(path).passes : 0);
        return done < 5;
    };
    render_reference(scene, "scene.pbrt", options, test_device(), 1e9, path, progress, 0.0);
    EXPECT_EQ(seen, (std::vector<std::uint64_t>{0, 1, 2, 3, 4, 5}));

    const std::string unwritten = folder.path("none.exr");
    EXPECT_EQ(error_of([&] {
                  render_reference(scene, "scene.pbrt", options, test_device(), 1e9, unwritten,
                                   [](std::uint64_t, double) { return false; });
              }),
              "interrupted before the first pass was done: no reference written");
    EXPECT_FALSE(std::filesystem::exists(unwritten));
}

} // namespace
} // namespace tristim::test::reference_command_test
