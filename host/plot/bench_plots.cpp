#include "plot/bench_plots.h"

#include "base/error.h"
#include "bench/results.h"
#include "image/error_map.h"
#include "image/output_file.h"
#include "plot/python.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace tristim {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 4> script{"host/plot/style.py", "host/plot/bench_style.py",
                                                 "host/plot/bench_images.py", "host/plot/bench_plots.py"};
constexpr int colour_steps = 256;

void check_name(const std::string& name) {
    const bool has_bad_character = std::any_of(name.begin(), name.end(), [](char c) {
        return c == '/' || (static_cast<unsigned char>(c) < 0x20) || c == 0x7f;
    });
    if (name.empty() || has_bad_character)
        fail("cannot draw the bench's plots: \"{}\" cannot be part of a file's name", name);
}

void check_names(const SceneResults& scene) {
    check_name(scene.name);
    for (const RunGroup& group : scene.groups)
        check_name(group.name);
    for (const NamedRegion& region : scene.regions)
        check_name(region.name);
}

/// Whether a member is a list of so many entries.
bool is_list(const Json& object, const char* key, std::size_t size) {
    return object.is_object() && object.contains(key) && object[key].is_array() && object[key].size() == size;
}

bool is_curve(const Json& curve) {
    return curve.is_object() && curve.contains("near_floor_from") && curve.contains("seconds") &&
           curve["seconds"].is_array() && is_list(curve, "median", curve["seconds"].size()) &&
           is_list(curve, "low", curve["seconds"].size()) && is_list(curve, "high", curve["seconds"].size());
}

bool is_comparison(const Json& comparison, std::size_t runs) {
    if (!is_list(comparison, "errors", runs) || !comparison.contains("equal_time") || !comparison.contains("levels") ||
        !is_list(comparison, "times", comparison["levels"].size()))
        return false;
    const Json& times = comparison["times"];
    return std::all_of(times.begin(), times.end(),
                       [&](const Json& row) { return row.is_array() && row.size() == runs; });
}

/// Whether a list has, per entry, a list of one item per region that passes a check.
template <typename Check>
bool has_all_regions(const Json& list, std::size_t regions, Check&& check) {
    std::size_t position = 0;
    return std::all_of(list.begin(), list.end(), [&](const Json& entry) {
        const std::size_t here = position++;
        return entry.is_array() && entry.size() == regions &&
               std::all_of(entry.begin(), entry.end(), [&](const Json& item) { return check(item, here); });
    });
}

/// The summary is ours, but a results.json can have been written by another version or by hand.
void check_summary(const Json& json, const SceneResults& scene) {
    const Json summary = json.value("summary", Json::object());
    const std::size_t regions = scene.regions.size();
    if (!is_list(summary, "curves", scene.runs.size()) ||
        !has_all_regions(summary["curves"], regions, [](const Json& curve, std::size_t) { return is_curve(curve); }))
        fail("cannot draw the bench's plots: the scene \"{}\" has no summary of each run's error in each region",
             scene.name);
    if (!is_list(summary, "groups", scene.groups.size()) ||
        !has_all_regions(summary["groups"], regions, [&](const Json& comparison, std::size_t group) {
            return is_comparison(comparison, scene.groups[group].runs.size());
        }))
        fail("cannot draw the bench's plots: the scene \"{}\" has no summary of each group in each region", scene.name);
}

std::string task_of(const Json& results, const std::string& folder) {
    Json colours = Json::array();
    for (int i = 0; i < colour_steps; ++i)
        colours.push_back(error_map_colour((i + 0.5) / colour_steps));
    const Json task{{"folder", folder},
                    {"error_map", {{"decades", error_map_decades}, {"colours", std::move(colours)}}},
                    {"scenes", results.at("scenes")}};
    return task.dump(-1, ' ', true, Json::error_handler_t::replace);
}

struct PlotFile {
    std::string_view name;
    std::string_view png;
};

/// Takes apart what bench_plots.py writes: per file "BYTES NAME\n" and the bytes.
std::vector<PlotFile> files_in(std::string_view output) {
    std::vector<PlotFile> files;
    while (!output.empty()) {
        const std::size_t line_end = output.find('\n');
        const std::string_view line = output.substr(0, line_end);
        std::size_t size = 0;
        const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), size);
        if (line_end == std::string_view::npos || error != std::errc() || end == line.data() + line.size() ||
            *end != ' ' || size > output.size() - line_end - 1)
            fail("cannot draw the bench's plots: what Python wrote is cut off or not a list of plots");
        files.push_back(
            {line.substr(static_cast<std::size_t>(end + 1 - line.data())), output.substr(line_end + 1, size)});
        output.remove_prefix(line_end + 1 + size);
    }
    return files;
}

} // namespace

void write_bench_plots(const Json& results, const std::string& folder) {
    const BenchResults checked = results_from_json(results, "the bench's results");
    for (std::size_t i = 0; i < checked.scenes.size(); ++i) {
        check_names(checked.scenes[i]);
        check_summary(results["scenes"][i], checked.scenes[i]);
    }
    const std::filesystem::path plots = std::filesystem::path(folder) / "plots";
    make_folder(plots.string());
    const std::string output = run_python(script, task_of(results, folder), "draw the bench's plots");
    for (const PlotFile& file : files_in(output))
        replace_file((plots / file.name).string(), file.png);
}

} // namespace tristim
