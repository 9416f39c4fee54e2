// Plots of a bench: what they show, and what happens where they cannot be drawn.
#include "bench/analysis.h"
#include "image/error_map.h"
#include "image/write_image.h"
#include "plot/bench_plots.h"
#include "png_pixels.h"
#include "scene_folder.h"
#include "synthetic_runs.h"

#include <cmath>
#include <map>
#include <optional>
#include <set>

namespace tristim::test {
namespace {

using Colour = std::array<int, 3>;

/// Okabe & Ito's blue and vermilion, in which a group's first two runs are drawn.
constexpr Colour first_colour{0x00, 0x72, 0xb2}, second_colour{0xd5, 0x5e, 0x00};

ErrorLaw law(double factor, double power = -0.5, double bias = 0.0) {
    return [=](double t) { return std::hypot(factor * std::pow(t, power), bias); };
}

nlohmann::ordered_json results_of(std::vector<SceneResults> scenes) {
    BenchResults results;
    results.devices = {{"a device", "", "", ""}};
    results.scenes = std::move(scenes);
    nlohmann::ordered_json json = to_json(results);
    for (std::size_t i = 0; i < results.scenes.size(); ++i)
        json["scenes"][i]["summary"] = summarise(results.scenes[i]);
    return json;
}

std::set<std::string> files_in(const std::string& folder) {
    std::set<std::string> names;
    if (std::filesystem::exists(folder)) {
        for (const auto& file : std::filesystem::directory_iterator(folder))
            names.insert(file.path().filename().string());
    }
    return names;
}

/// Mean row of a colour in each column that has it.
std::map<int, double> rows_of(const Pixels& image, const Colour& colour) {
    std::map<int, double> sums, counts;
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
        if (image.rgb[i] != colour)
            continue;
        const int column = static_cast<int>(i) % image.width;
        sums[column] += static_cast<double>(static_cast<int>(i) / image.width);
        counts[column] += 1.0;
    }
    for (auto& [column, sum] : sums)
        sum /= counts[column];
    return sums;
}

std::array<double, 2> centre_of(const Pixels& image, const Colour& colour) {
    double x = 0.0, y = 0.0, count = 0.0;
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
        if (image.rgb[i] == colour) {
            x += static_cast<double>(static_cast<int>(i) % image.width);
            y += static_cast<double>(static_cast<int>(i) / image.width);
            count += 1.0;
        }
    }
    return {x / count, y / count};
}

/// Markers on the first curve whose middle is white: between the colour above and below.
int hollow_points(const Pixels& image) {
    int points = 0;
    int last_column = -2;
    for (const auto& [column, row] : rows_of(image, first_colour)) {
        const auto middle = static_cast<std::size_t>(std::lround(row)) * static_cast<std::size_t>(image.width) +
                            static_cast<std::size_t>(column);
        if (image.rgb[middle] != Colour{255, 255, 255})
            continue;
        points += column != last_column + 1 ? 1 : 0;
        last_column = column;
    }
    return points;
}

/// The last column of each bar of a colour, from the top, the legend's left out.
std::vector<int> bar_ends(const Pixels& image, const Colour& colour) {
    std::vector<int> ends;
    int last_row = -2;
    for (int row = 0; row < image.height; ++row) {
        int end = -1;
        for (int column = 0; column < 3 * image.width / 4; ++column) {
            if (image.rgb[static_cast<std::size_t>(row * image.width + column)] == colour)
                end = column;
        }
        if (end < 0)
            continue;
        if (row != last_row + 1)
            ends.push_back(end);
        last_row = row;
    }
    return ends;
}

TEST(BenchPlots, CurvesOfPowerLawsAreParallelStraightLines) {
    const SceneFolder folder;
    SceneResults scene = scene_of({run_of("low", {law(0.1)}), run_of("high", {law(0.4)})});
    for (CurvePoint& point : scene.runs[1].repeats[0].checkpoints)
        point.memory = 100 << 20;
    write_bench_plots(results_of({scene}), folder.path(""));
    EXPECT_EQ(files_in(folder.path("plots")),
              (std::set<std::string>{"scene-methods-image-time.png", "scene-methods-image-bars.png",
                                     "scene-methods-memory.png"}));

    const Pixels time = read_png(folder.path("plots/scene-methods-image-time.png"));
    std::array<double, 2> slopes{};
    std::array<double, 2> heights{};
    for (std::size_t run = 0; run < 2; ++run) {
        const std::map<int, double> rows = rows_of(time, run == 0 ? first_colour : second_colour);
        const int left = time.width / 4, right = 3 * time.width / 4; // within the axes
        ASSERT_TRUE(rows.contains(left) && rows.contains(right));
        slopes[run] = (rows.at(right) - rows.at(left)) / (right - left);
        heights[run] = rows.at(left);
        for (int x = left; x < right; ++x) {
            ASSERT_TRUE(rows.contains(x)) << "a gap at " << x;
            // Lines and markers are symmetric about the curve, but in a square's outer columns the mean is its centre's
            // row, up to half its 5 points away; smoothing shifts what keeps its colour by a pixel.
            const double half_marker = 2.5 * 150.0 / 72.0;
            EXPECT_NEAR(rows.at(x), rows.at(left) + slopes[run] * (x - left), half_marker * slopes[run] + 1.0) << x;
        }
    }
    EXPECT_GT(slopes[0], 0.1) << "errors fall, rows count downwards";
    EXPECT_NEAR(slopes[1], slopes[0], 4.0 / (time.width / 2)); // two pixels at either end
    EXPECT_GT(heights[0], heights[1] + 20);

    const Pixels memory = read_png(folder.path("plots/scene-methods-memory.png"));
    const int legend = memory.width / 2; // one panel fills more than this
    const std::map<int, double> low = rows_of(memory, first_colour), high = rows_of(memory, second_colour);
    ASSERT_FALSE(low.empty() || high.empty());
    EXPECT_LT(low.begin()->first, legend);
    EXPECT_LT(low.begin()->first + 100, high.begin()->first) << "more memory is to the right";
    EXPECT_GT(low.begin()->second, high.begin()->second + 20) << "less error is below";
}

TEST(BenchPlots, BandFloorAndHollowPoints) {
    const SceneFolder folder;
    std::vector<SceneResults> scenes{scene_of({noisy_run("a", 0.1, 0.0)}), scene_of({noisy_run("a", 0.1, 0.3)}),
                                     scene_of({noisy_run("a", 0.1, 0.0)}, 0.005)};
    scenes[0].name = "plain";
    scenes[1].name = "band";
    scenes[2].name = "floor";
    write_bench_plots(results_of(scenes), folder.path(""));
    const auto time = [&](const std::string& name) {
        return read_png(folder.path("plots/" + name + "-methods-image-time.png"));
    };
    const Pixels plain = time("plain"), band = time("band"), floor = time("floor");
    const Colour pale{209, 230, 241}; // 18 % of the blue on white
    const auto near_pale = [&](const Pixels& image) {
        return std::count_if(image.rgb.begin(), image.rgb.end(), [&](const Colour& pixel) {
            return std::abs(pixel[0] - pale[0]) <= 1 && std::abs(pixel[1] - pale[1]) <= 1 &&
                   std::abs(pixel[2] - pale[2]) <= 1;
        });
    };
    EXPECT_GT(near_pale(band), 10'000);
    EXPECT_LT(near_pale(plain), 500);

    // 0.1 t^-1/2 falls below three times 0.005 at 44 s: of the eleven points, at 0.1 · 2^k s, the last two.
    const Colour shade{237, 237, 237}; // 7 % of black on white
    EXPECT_GT(floor.count(shade), 10'000);
    EXPECT_LT(plain.count(shade), 100) << "smoothed letters alone";
    EXPECT_EQ(hollow_points(floor), 2);
    EXPECT_EQ(hollow_points(plain), 0);
}

TEST(BenchPlots, BarsAreAsLongAsTheTimes) {
    const SceneFolder folder;
    // 0.05 and 0.02 by both; 0.01 by the first alone, as the second one's bias keeps it above.
    SceneResults scene = scene_of({run_of("a", {law(0.1)}, 0.1, 103.0), run_of("b", {law(0.1, -0.5, 0.015)})});
    nlohmann::ordered_json results = results_of({scene});
    auto& summary = results["scenes"][0]["summary"]["groups"][0][0];
    summary["levels"] = {0.05, 0.01};
    summary["times"] = {{1.0, 2.0}, {4.0, nullptr}};
    write_bench_plots(results, folder.path(""));
    const Pixels image = read_png(folder.path("plots/scene-methods-image-bars.png"));
    const std::vector<int> first = bar_ends(image, first_colour), second = bar_ends(image, second_colour);
    ASSERT_EQ(first.size(), 2U);
    ASSERT_EQ(second.size(), 1U) << "a time that is not reached has a pale bar";
    // On a logarithmic axis 1 to 2 is half as far as 1 to 4; a pixel's rounding at each end.
    EXPECT_GT(first[1], first[0] + 100);
    EXPECT_NEAR(second[0] - first[0], (first[1] - first[0]) / 2.0, 2.0);
}

TEST(BenchPlots, ImagesAboveTheirErrorMaps) {
    const SceneFolder folder;
    std::filesystem::create_directory(folder.path("images"));
    const std::vector<std::array<std::uint8_t, 3>> colours{{200, 10, 30}, {10, 200, 30}, {30, 10, 200}, {200, 200, 10}};
    const auto write = [&](const std::string& name, std::size_t colour) {
        write_png(folder.path(name), 8, 6, std::vector(48, colours[colour]));
        return name;
    };
    SceneResults scene = scene_of({run_of("a", {law(0.1)}), run_of("b", {law(0.2)}), run_of("c", {law(0.3)})});
    scene.image = write("images/reference.png", 0);
    scene.runs[0].image = write("images/a.png", 1);
    scene.runs[0].error_map = write("images/a-error.png", 2);
    scene.runs[1].image = write("images/b.png", 3); // whose error map is missing
    scene.runs[1].error_map = "images/b-error.png";
    scene.runs[2].image = "images/c.png"; // missing itself
    scene.error_map_scale = 0.5;
    write_bench_plots(results_of({scene}), folder.path(""));
    const Pixels sheet = read_png(folder.path("plots/scene-images.png"));
    std::vector<std::array<double, 2>> centres;
    for (const auto& [r, g, b] : colours) {
        EXPECT_GT(sheet.count({r, g, b}), 10'000);
        centres.push_back(centre_of(sheet, {r, g, b}));
    }
    EXPECT_LT(centres[0][0] + 50, centres[1][0]) << "the reference comes first";
    EXPECT_NEAR(centres[0][1], centres[1][1], 2.0) << "in one row";
    EXPECT_NEAR(centres[1][0], centres[2][0], 2.0) << "the error map under its image";
    EXPECT_LT(centres[1][1] + 50, centres[2][1]);
    EXPECT_LT(centres[1][0] + 50, centres[3][0]);
    int in_bar = 0; // of the colour bar's 256 steps, one to two pixels wide each
    for (int i = 0; i < 256; ++i) {
        const Rgb colour = error_map_colour((i + 0.5) / 256.0);
        Colour step{};
        for (std::size_t c = 0; c < 3; ++c)
            step[c] = static_cast<int>(std::lround(255.0 * colour[c]));
        in_bar += sheet.count(step) > 0 ? 1 : 0;
    }
    EXPECT_GT(in_bar, 200);
}

TEST(BenchPlots, FewAndManyRunsAndAnyLabel) {
    const SceneFolder folder;
    SceneResults nothing = scene_of({run_of("a", {})});
    nothing.name = "nothing";
    SceneResults one_point =
        scene_of({run_of("a", {law(0.1)}, 0.1, 0.15), run_of("b", {}), run_of("c", {law(0.2)})}, 5.0);
    one_point.name = "one point";
    std::vector<BenchRun> runs;
    for (int i = 0; i < 12; ++i)
        runs.push_back(run_of(fmt::format("$\\frac{{<b>&{} {}", i, std::string(200, 'x')), {law(0.1 * (1 + i))}));
    SceneResults many = scene_of(runs, 1e-9);
    many.name = "many";
    SceneResults zero = scene_of({run_of("exact", {law(0.0)}), run_of("\xff", {law(0.1)})});
    zero.name = "zero";
    nlohmann::ordered_json results = results_of({nothing, one_point, many, zero});
    results["scenes"][2]["summary"]["curves"][0][0]["median"][3] = nullptr;
    write_bench_plots(results, folder.path(""));
    std::set<std::string> expected;
    for (const char* scene : {"nothing", "one point", "many", "zero"}) {
        for (const char* kind : {"-methods-image-time.png", "-methods-image-bars.png", "-methods-memory.png"})
            expected.insert(std::string(scene) + kind);
    }
    EXPECT_EQ(files_in(folder.path("plots")), expected);
    for (const std::string& name : expected) {
        const Pixels image = read_png(folder.path("plots/" + name));
        EXPECT_GE(image.width, 1400) << name;
        EXPECT_GE(image.height, 300) << name;
    }
    EXPECT_GT(read_png(folder.path("plots/many-methods-image-time.png")).count(second_colour), 1000);
}

/// Another Python, for as long as this stands.
class ChosenPython {
  public:
    explicit ChosenPython(const std::string& path) {
        if (const char* old = std::getenv("TRISTIM_PYTHON"))
            old_ = old;
        ::setenv("TRISTIM_PYTHON", path.c_str(), 1);
    }
    ~ChosenPython() {
        if (old_)
            ::setenv("TRISTIM_PYTHON", old_->c_str(), 1);
        else
            ::unsetenv("TRISTIM_PYTHON");
    }
    ChosenPython(const ChosenPython&) = delete;
    ChosenPython& operator=(const ChosenPython&) = delete;

  private:
    std::optional<std::string> old_;
};

TEST(BenchPlots, DamagedResults) {
    const SceneFolder folder;
    const nlohmann::ordered_json whole = results_of({scene_of({run_of("a", {law(0.1)}), run_of("b", {law(0.2)})})});
    const auto expect_refused = [&](const std::string& start, const std::string& words, auto&& damage) {
        nlohmann::ordered_json results = whole;
        damage(results);
        expect_message(error_of([&] { write_bench_plots(results, folder.path("")); }), start, words);
    };
    const auto scene = [](nlohmann::ordered_json & results) -> auto& {
        return results["scenes"][0];
    };
    const std::string cannot_use = "cannot use \"the bench's results\"";
    const std::string cannot_draw = "cannot draw the bench's plots: ";
    expect_refused(cannot_use, "missing", [](auto& results) { results = nlohmann::ordered_json::object(); });
    expect_refused(cannot_use, "missing", [&](auto& results) { scene(results).erase("runs"); });
    const std::string no_curves = "scene \"scene\" has no summary of each run's error";
    expect_refused(cannot_draw, no_curves, [&](auto& results) { scene(results).erase("summary"); });
    expect_refused(cannot_draw, no_curves, [&](auto& results) { scene(results)["summary"] = 3; });
    expect_refused(cannot_draw, no_curves, [&](auto& results) { scene(results)["summary"]["curves"].erase(1); });
    expect_refused(cannot_draw, no_curves,
                   [&](auto& results) { scene(results)["summary"]["curves"][0][0]["low"].erase(0); });
    const std::string no_groups = "scene \"scene\" has no summary of each group";
    const auto group = [&](auto& results) -> auto& {
        return scene(results)["summary"]["groups"][0][0];
    };
    expect_refused(cannot_draw, no_groups, [&](auto& results) { scene(results)["summary"]["groups"] = {}; });
    expect_refused(cannot_draw, no_groups, [&](auto& results) { group(results)["times"][0].erase(0); });
    expect_refused(cannot_draw, no_groups, [&](auto& results) { group(results).erase("equal_time"); });
    expect_refused(cannot_draw, "cannot be part of a file's name",
                   [&](auto& results) { scene(results)["name"] = "../scene"; });
    expect_refused(cannot_draw, "cannot be part of a file's name",
                   [&](auto& results) { scene(results)["regions"][0]["name"] = ""; });
    EXPECT_EQ(files_in(folder.path("")), std::set<std::string>());
    // A picture that is none is found out only by Python.
    expect_refused(cannot_draw, "failed with status 1", [&](auto& results) {
        folder.write("not-an-image.png", "text");
        scene(results)["image"] = "not-an-image.png";
    });
    EXPECT_EQ(files_in(folder.path("plots")), std::set<std::string>());
}

TEST(BenchPlots, FailureLeavesOldPlots) {
    const SceneFolder folder;
    const nlohmann::ordered_json results = results_of({scene_of({run_of("a", {law(0.1)})})});
    std::filesystem::create_directory(folder.path("plots"));
    const std::string old = folder.write("plots/scene-methods-image-time.png", "what was there");
    const auto expect_failure = [&](const std::string& script, const std::string& words) {
        const std::string python = folder.write("python", "#!/bin/sh\n" + script + "\n");
        std::filesystem::permissions(python, std::filesystem::perms::owner_all);
        const ChosenPython chosen(python);
        expect_message(error_of([&] { write_bench_plots(results, folder.path("")); }),
                       "cannot draw the bench's plots: ", words);
        EXPECT_EQ(files_in(folder.path("plots")), (std::set<std::string>{"scene-methods-image-time.png"}));
        std::ifstream file(old);
        EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "what was there");
    };
    expect_failure("exit 3", "Python has no matplotlib (Debian: apt install python3-matplotlib)");
    expect_failure("exit 127", "there is no Python 3 (Debian: apt install python3-matplotlib)");
    expect_failure("echo first >&2; echo 'it broke' >&2; exit 1", "it broke");
    // The list ends early: not even the file that is whole is written.
    expect_failure("printf '4 scene-methods-image-time.png\\nabcd100 b.png\\nabc'", "cut off");
    expect_failure("echo hello", "cut off");
}

} // namespace
} // namespace tristim::test
