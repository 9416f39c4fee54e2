#include "report/report.h"

#include "bench/analysis.h"
#include "image/output_file.h"
#include "plot/bench_plots.h"
#include "report/report_page.h"

#include <filesystem>

namespace tristim {
namespace {

/// Empties the names of images that do not exist; returns what they were.
std::vector<std::string> drop_missing_images(nlohmann::ordered_json& results, const std::filesystem::path& folder) {
    std::vector<std::string> missing;
    const auto check = [&](nlohmann::ordered_json& image) {
        const auto name = image.get<std::string>();
        if (name.empty() || std::filesystem::exists(folder / name))
            return;
        missing.push_back(name);
        image = "";
    };
    for (auto& scene : results["scenes"]) {
        check(scene["image"]);
        for (auto& run : scene["runs"]) {
            check(run["image"]);
            check(run["error_map"]);
        }
    }
    return missing;
}

} // namespace

std::vector<std::string> write_report(const std::string& folder) {
    const auto path = [&](const char* name) { return (std::filesystem::path(folder) / name).string(); };
    const BenchResults results = read_results(path("results.json"));
    nlohmann::ordered_json json = to_json(results);
    for (std::size_t i = 0; i < results.scenes.size(); ++i)
        json["scenes"][i]["summary"] = summarise(results.scenes[i]);
    replace_file(path("results.json"), json.dump(1) + "\n");
    replace_file(path("results.csv"), results_csv(results));
    const std::vector<std::string> missing = drop_missing_images(json, folder);
    write_bench_plots(json, folder);
    write_report_page(json, folder);
    return missing;
}

} // namespace tristim
