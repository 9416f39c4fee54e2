#pragma once
// A tiny scene in a folder, and benches of it.

#include "bench/bench.h"
#include "bench/machine.h"
#include "bench/reference.h"
#include "bench/regions.h"
#include "bench_scenes.h"
#include "scene_folder.h"

#include <filesystem>
#include <iterator>
#include <map>

namespace tristim::test {

/// A floor under a lamp; 256 photons a pass, so that a pass takes well below a millisecond.
inline std::string tiny_scene(const std::string& reflectance = "0.7 0.3 0.1", int fov = 90) {
    return "Camera \"perspective\" \"float fov\" [ " + std::to_string(fov) +
           " ]\n"
           "Film \"rgb\" \"integer xresolution\" [ 16 ] \"integer yresolution\" [ 16 ]\n"
           "Integrator \"sppm\" \"integer photonsperiteration\" [ 256 ] \"float radius\" [ 0.5 ]\n"
           "WorldBegin\n"
           "LightSource \"point\" \"point3 from\" [ 0 1 0 ] \"spectrum I\" \"stdillum-A\" \"float scale\" [ 10 ]\n"
           "Material \"diffuse\" \"rgb reflectance\" [ " +
           reflectance +
           " ]\n"
           "Shape \"bilinearmesh\" \"point3 P\" [ -20 -20 5  20 -20 5  -20 20 5  20 20 5 ]\n";
}

inline nlohmann::ordered_json read_json(const std::string& path) {
    return nlohmann::ordered_json::parse(read_text(path));
}

/// Paths below a folder, relative to it, and what the files hold, but for the peak memory of this process, which may
/// grow between two writings of the same results.
inline std::map<std::string, std::string> contents(const std::string& folder) {
    const std::string peak_memory = "\"peak_process_memory\"";
    std::map<std::string, std::string> result;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        result[std::filesystem::relative(entry.path(), folder).string()] =
            entry.is_regular_file() ? read_text(entry.path().string()) : "";
    const auto results = result.find("results.json");
    const std::size_t peak = results == result.end() ? std::string::npos : results->second.find(peak_memory);
    if (peak != std::string::npos)
        results->second.erase(peak, results->second.find('\n', peak) - peak);
    return result;
}

/// What a bench of one scene is planned from.
struct TinyBench {
    std::string scene_file;
    std::string folder;
    std::string methods = "rgb,tristimulus:1";
    double seconds = 0.04;
    double reference_seconds = 0.1;
    std::string reference_method = "tristimulus:1";
    int repeats = 2;
    std::uint32_t seed = 0;
    std::vector<std::string> regions{"left=0,0,8,16"};
    std::string reference;
    std::function<void(RenderOptions&)> change = [](RenderOptions&) {};
    std::size_t devices = 1;
    bool costs = false;

    RenderOptions options(const Scene& scene) const {
        RenderOptions result = options_from_scene(scene.settings);
        result.method = parse_method("tristimulus:1");
        change(result);
        return result;
    }

    BenchPlan plan() const {
        BenchPlan plan;
        plan.folder = folder;
        plan.reference_seconds = reference_seconds;
        plan.devices.assign(devices, test_device());
        plan.results.devices.assign(devices, describe_device(test_device()));
        plan.results.kind = costs ? "costs" : "methods";
        plan.results.version = "test";
        plan.results.seconds = seconds;
        plan.results.repeats = repeats;
        plan.results.seed = seed;
        const Scene scene = load_scene(scene_file);
        const RenderOptions base = options(scene);
        plan.scenes.push_back(plan_scene(scene, scene_file, {method_variants(methods, base)}, plan.devices,
                                         named_regions(scene, base, regions)));
        plan.scenes[0].reference_options = base;
        plan.scenes[0].reference_options.method = parse_method(reference_method);
        plan.scenes[0].reference_options.seed = reference_seed;
        plan.scenes[0].given_reference = reference;
        return plan;
    }

    bool run(
        bool resume, const BenchCallback& callback = [](const BenchProgress&) { return true; }) const {
        BenchPlan now = plan();
        return run_bench(now, resume, callback);
    }

    std::string path(const std::string& name) const { return folder + "/" + name; }
    BenchResults results() const { return read_results(path("results.json")); }
};

} // namespace tristim::test
