// Plots: what is drawn, and what happens where it cannot be.
#include "child_process.h"
#include "plot/plot.h"
#include "png_pixels.h"
#include "scene_folder.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>

namespace tristim::test {
namespace {

std::size_t files_in(const SceneFolder& folder) {
    const auto files = std::filesystem::directory_iterator(folder.path(""));
    return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

Plot two_lines() {
    return {"A title", "x", "y", {{"up", {0, 1, 2}, {0, 1, 2}}, {"down", {0, 1, 2}, {2, 1, 0}}}, {}, {}};
}

/// Okabe & Ito's blue and vermilion, in which the first two curves are drawn.
constexpr std::array<int, 3> first_colour{0x00, 0x72, 0xb2}, second_colour{0xd5, 0x5e, 0x00};

TEST(Plots, DrawsEveryCurve) {
    const SceneFolder folder;
    const std::string path = folder.path("two lines.png");
    write_plot(two_lines(), path);
    const Pixels image = read_png(path);
    EXPECT_GE(image.width, 800);
    EXPECT_GE(image.height, 450);
    // A curve over the whole width is some pixels thick: a thousand of them at least, the rest being smoothed.
    EXPECT_GT(image.count(first_colour), 1000);
    EXPECT_GT(image.count(second_colour), 1000);
    EXPECT_EQ(files_in(folder), 1U) << "a temporary file was left";
}

TEST(Plots, StripShowsItsColoursFromLeftToRight) {
    const SceneFolder folder;
    const std::string path = folder.path("strip.png");
    Plot plot = two_lines();
    plot.strip = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.2, 0.4, 0.6}};
    plot.strip_label = "colours";
    write_plot(plot, path);
    const Pixels image = read_png(path);
    const std::array<std::array<int, 3>, 3> colours{{{255, 0, 0}, {0, 255, 0}, {51, 102, 153}}};
    std::array<double, 3> middle{};
    for (std::size_t c = 0; c < 3; ++c) {
        const int count = image.count(colours[c]);
        ASSERT_GT(count, 10'000);
        EXPECT_NEAR(count, image.count(colours[0]), 0.02 * count) << "colours are equally wide";
        for (std::size_t i = 0; i < image.rgb.size(); ++i)
            middle[c] +=
                image.rgb[i] == colours[c] ? static_cast<double>(i % static_cast<std::size_t>(image.width)) : 0;
        middle[c] /= count;
    }
    EXPECT_LT(middle[0] + 100, middle[1]);
    EXPECT_LT(middle[1] + 100, middle[2]);
}

TEST(Plots, AnyTextGapsAndManySamples) {
    const SceneFolder folder;
    const std::string path = folder.path("it's $(touch gone) `x` \"q\".png");
    Plot plot = two_lines();
    plot.title = "it's $(touch gone) \"quoted\" $\\frac{ \xff %s {} \n λ";
    plot.series[0].label = "_hidden $x";
    plot.series[0].y[1] = std::numeric_limits<double>::quiet_NaN();
    for (int i = 3; i < 100'000; ++i) { // more than a pipe holds
        plot.series[0].x.push_back(i);
        plot.series[0].y.push_back(std::sin(i * 1e-4));
    }
    write_plot(plot, path);
    EXPECT_GT(read_png(path).count(first_colour), 1000);
    EXPECT_EQ(files_in(folder), 1U);
    EXPECT_FALSE(std::filesystem::exists("gone"));
}

TEST(Plots, BadCurvesAndFiles) {
    const SceneFolder folder;
    Plot plot = two_lines();
    plot.series[1].y.pop_back();
    EXPECT_NE(error_of([&] { write_plot(plot, folder.path("a.png")); }).find("\"down\""), std::string::npos);
    EXPECT_NE(error_of([&] { write_plot(two_lines(), folder.path("a.pdf")); }).find(".png"), std::string::npos);
    EXPECT_NE(error_of([&] { write_plot(two_lines(), folder.path("no/a.png")); }).find("does not exist"),
              std::string::npos);
    EXPECT_EQ(files_in(folder), 0U);
}

/// Runs a small film plot by a Python, onto a file that exists. It must fail, say so in one line and leave the file.
void expect_plot_failure(const std::string& python, const std::string& words) {
    const SceneFolder folder;
    const std::string path = folder.write("old.png", "what was there");
    const ChildResult result =
        run_tristim({"film", "air|1.5", "--wavelength=400:700:100", "--plot", path}, {{"TRISTIM_PYTHON", python}});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.standard_error.find(words), std::string::npos) << result.standard_error;
    EXPECT_EQ(std::count(result.standard_error.begin(), result.standard_error.end(), '\n'), 1) << result.standard_error;
    EXPECT_EQ(result.standard_output, "");
    EXPECT_EQ(read_text(path), "what was there");
    EXPECT_EQ(files_in(folder), 1U);
}

TEST(Plots, WithoutPythonOrMatplotlib) {
    const SceneFolder folder;
    const auto script = [&](const std::string& name, const std::string& text) {
        const std::string path = folder.write(name, "#!/bin/sh\n" + text + "\n");
        std::filesystem::permissions(path, std::filesystem::perms::owner_all);
        return path;
    };
    expect_plot_failure("/nonexistent/python3", "there is no Python 3 (Debian: apt install python3-matplotlib)");
    expect_plot_failure(folder.write("not-executable", ""), "there is no Python 3");
    expect_plot_failure(script("bare", "exit 3"), "no matplotlib (Debian: apt install python3-matplotlib)");
    expect_plot_failure(script("broken", "echo first >&2; echo 'it broke' >&2; exit 1"), "it broke");
    expect_plot_failure(script("killed", "kill -9 $$"), "status 137");
}

TEST(Plots, OfFilms) {
    const SceneFolder folder;
    const std::vector<std::vector<std::string>> cases{
        {"air|SiO2:300|Si"},
        {"air|SiO2:300|Si", "--angle=0:80:10"},
        {"air|Au:20|1.5", "--angle=45", "--wavelength=550"},
        {"air|soap:0|air", "--sweep=0:1000:10"},
    };
    for (std::size_t i = 0; i < cases.size(); ++i) {
        std::vector<std::string> arguments{"film"};
        arguments.insert(arguments.end(), cases[i].begin(), cases[i].end());
        const std::string path = folder.path(fmt::format("{}.png", i));
        arguments.insert(arguments.end(), {"--plot", path});
        const ChildResult result = run_tristim(arguments);
        EXPECT_EQ(result.exit_code, 0) << result.standard_error;
        EXPECT_EQ(result.standard_output, "");
        EXPECT_GT(read_png(path).count(first_colour), 20) << i; // one lone point is a small disc
    }
}

} // namespace
} // namespace tristim::test
