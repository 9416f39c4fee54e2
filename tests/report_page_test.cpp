// report.html: opened in a browser by report_page.py, which compares what it shows with the results.
#include "bench/analysis.h"
#include "child_process.h"
#include "image/write_image.h"
#include "report/report_page.h"
#include "scene_folder.h"
#include "synthetic_runs.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace tristim::test {
namespace {

constexpr int width = 48, height = 32;

/// A PNG of one colour.
void write_plain_png(const SceneFolder& folder, const std::string& name, const std::array<float, 3>& xyz) {
    XyzImage image{width, height, {0, 0, width, height}, {}};
    image.xyz.assign(width * height, xyz);
    write_png(folder.path(name), image, {ToneMapping::Kind::Linear, 0.0});
}

/// Names as users may choose them, and as they may break a page. report_page.py knows the second.
const std::array<std::string, 3> labels{"tristimulus:20", "a <b>&\"quoted\"</b> 'run'", "</script><script>throw 1;//"};

/// Errors c / sqrt(t), 20 % less in the first and more in the second repeat; twice that in the second region.
BenchRun repeated_run(std::size_t i, double c) {
    BenchRun run;
    run.id = std::to_string(i);
    run.label = labels[i];
    run.options = {{"method", labels[i]}, {"photons", 65536}};
    run.memory = {std::uint64_t{600'000} << i, 300'000, 100'000, 64.0, 140.0};
    for (const double factor : {0.8, 1.2}) {
        Repeat repeat;
        repeat.seed = static_cast<std::uint32_t>(run.repeats.size() + 1);
        repeat.build_seconds = 0.5;
        repeat.compare_seconds = 0.25;
        repeat.finished = true;
        for (double t = 1.0; t <= 64.0; t *= 2.0) {
            const double error = factor * c / std::sqrt(t);
            repeat.checkpoints.push_back({t,
                                          static_cast<std::uint64_t>(10.0 * t),
                                          static_cast<std::uint64_t>(1000.0 * t),
                                          1'048'576U << i,
                                          {error, 2.0 * error},
                                          {error * error, 4.0 * error * error}});
        }
        run.repeats.push_back(repeat);
    }
    return run;
}

/// Two scenes of three runs, two regions and two repeats, with their images in the folder.
BenchResults synthetic_results(const SceneFolder& folder) {
    BenchResults results;
    results.version = "0.1.0";
    results.started = "2020-02-02T20:20:20Z";
    results.command = "tristim bench 'a & b.pbrt' --out <DIR>";
    results.machine = {"A processor", 2, std::uint64_t{8} << 30, "Linux 6.1.0"};
    results.devices = {{"A device", "A platform", "1.2.3", "OpenCL C 1.2"}};
    results.seconds = 64.0;
    results.repeats = 2;
    results.seed = 1;
    for (const std::string name : {"glass & <light>", "second"}) {
        const double brightness = results.scenes.empty() ? 1.0 : 0.5;
        SceneResults scene = scene_of({});
        const std::string files = results.scenes.empty() ? "it's-" : "second-";
        for (std::size_t i = 0; i < labels.size(); ++i) {
            scene.runs.push_back(repeated_run(i, brightness * 0.1 * std::exp2(i)));
            scene.runs[i].image = files + std::to_string(i) + ".png";
            scene.runs[i].error_map = files + std::to_string(i) + "-error.png";
            write_plain_png(folder, scene.runs[i].image, {0.41F, 0.21F, 0.02F}); // red
            write_plain_png(folder, scene.runs[i].error_map, {0.2F, 0.2F, 0.2F});
        }
        scene.name = name;
        scene.file = "a & b.pbrt";
        scene.width = width;
        scene.height = height;
        scene.regions = {{"image", {0, 0, width, height}}, {"<i>glass</i>", {12, 8, 24, 16}}};
        scene.reference = {"reference.exr", "spectral:400", 20'480,      3600.0, 77,
                           {0.008, 0.016},  {0.006, 0.012}, {0.01, 0.02}};
        scene.image = files + "reference.png";
        write_plain_png(folder, scene.image, {0.18F, 0.07F, 0.95F}); // blue
        scene.error_map_scale = 0.5;
        scene.groups = {{"methods", "Methods", {0, 1, 2}, {labels.begin(), labels.end()}, 1, {}}};
        results.scenes.push_back(scene);
    }
    return results;
}

nlohmann::ordered_json with_summaries(const BenchResults& results) {
    nlohmann::ordered_json json = to_json(results);
    for (std::size_t i = 0; i < results.scenes.size(); ++i)
        json["scenes"][i]["summary"] = summarise(results.scenes[i]);
    return json;
}

TEST(ReportPage, ShowsTheResultsInABrowser) {
    const SceneFolder folder;
    const nlohmann::ordered_json json = with_summaries(synthetic_results(folder));
    folder.write("results.json", json.dump());
    write_report_page(json, folder.path(""));
    // The page stands alone: what it was made from may go.
    for (const auto& file : std::filesystem::directory_iterator(folder.path("")))
        if (file.path().extension() == ".png")
            std::filesystem::remove(file.path());
    const ChildResult browser =
        run_program("/usr/bin/python3", {TRISTIM_SOURCE_DIR "/tests/report_page.py", folder.path("")});
    EXPECT_EQ(browser.exit_code, 0) << browser.standard_output << browser.standard_error;
}

TEST(ReportPage, KeepsTheLicenceOfItsLibrary) {
    const SceneFolder folder;
    write_report_page(with_summaries(synthetic_results(folder)), folder.path(""));
    std::ifstream file(folder.path("report.html"), std::ios::binary);
    const std::string page{std::istreambuf_iterator<char>(file), {}};
    EXPECT_NE(page.find("Chart.js v"), std::string::npos);
    EXPECT_NE(page.find("Released under the MIT License"), std::string::npos);
}

TEST(ReportPage, MissingOrBrokenImageIsAnError) {
    const SceneFolder folder;
    const nlohmann::ordered_json json = with_summaries(synthetic_results(folder));
    const std::string image = folder.path("second-1-error.png");
    folder.write("second-1-error.png", "text");
    expect_message(error_of([&] { write_report_page(json, folder.path("")); }), "the report needs", image);
    std::filesystem::remove(image);
    expect_message(error_of([&] { write_report_page(json, folder.path("")); }), "", image);
    EXPECT_FALSE(std::filesystem::exists(folder.path("report.html")));
}

} // namespace
} // namespace tristim::test
