#include "bench/plan.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fmt/format.h>
#include <set>

namespace tristim {
namespace {

/// Letters, digits, '-', '_' and '.' as they are, all else a '-'.
std::string file_name_part(std::string text) {
    for (char& c : text) {
        if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_' && c != '.')
            c = '-';
    }
    return text;
}

std::string scene_name(const std::string& file) {
    const std::filesystem::path path = std::filesystem::weakly_canonical(file);
    const std::string folder = path.parent_path().filename().string();
    const std::string stem = path.stem().string();
    if (folder.empty())
        return file_name_part(stem);
    return file_name_part(stem == "scene" ? folder : folder + "-" + stem);
}

/// The variant's label, with the device where there are several: its name, numbered where several share it.
std::string label_on(const Variant& variant, const std::vector<Device>& devices, std::size_t device) {
    if (devices.size() == 1)
        return variant.label;
    const auto same_name = [&](const Device& other) { return other.info.name == devices[device].info.name; };
    const std::string label = variant.label + " on " + devices[device].info.name;
    if (std::count_if(devices.begin(), devices.end(), same_name) == 1)
        return label;
    const auto end = devices.begin() + static_cast<std::ptrdiff_t>(device) + 1;
    return fmt::format("{} ({})", label, std::count_if(devices.begin(), end, same_name));
}

/// The run that renders with these options on this device, made if there is none.
std::size_t find_run(PlannedScene& planned, const Variant& variant, const std::vector<Device>& devices,
                     std::size_t device) {
    SceneResults& results = planned.results;
    const nlohmann::ordered_json options = options_json(variant.options);
    for (std::size_t i = 0; i < results.runs.size(); ++i) {
        if (results.runs[i].options == options && results.runs[i].device == device)
            return i;
    }
    Run run;
    run.label = label_on(variant, devices, device);
    run.id = fmt::format("{}-{}", results.runs.size(), file_name_part(variant.label));
    run.device = device;
    run.options = options;
    results.runs.push_back(run);
    planned.options.push_back(variant.options);
    return results.runs.size() - 1;
}

} // namespace

std::string reference_name(const PlannedScene& planned) {
    return planned.given_reference.empty() ? "reference-" + planned.results.name + ".exr" : planned.given_reference;
}

PlannedScene plan_scene(Scene scene, const std::string& file, const std::vector<VariantGroup>& groups,
                        const std::vector<Device>& devices, std::vector<NamedRegion> regions) {
    PlannedScene planned;
    planned.scene = std::move(scene);
    planned.results.name = scene_name(file);
    planned.results.file = file;
    planned.results.regions = std::move(regions);
    for (const VariantGroup& group : groups) {
        RunGroup runs{group.name, group.title, {}, {}, 0, {}};
        for (std::size_t device = 0; device < devices.size(); ++device) {
            for (std::size_t i = 0; i < group.variants.size(); ++i) {
                const Variant& variant = group.variants[i];
                const std::size_t run = find_run(planned, variant, devices, device);
                if (device == 0 && i == group.baseline)
                    runs.baseline = run;
                runs.runs.push_back(run);
                runs.labels.push_back(label_on(variant, devices, device));
            }
        }
        planned.results.groups.push_back(std::move(runs));
    }
    planned.results.width = planned.options.front().width;
    planned.results.height = planned.options.front().height;
    return planned;
}

void make_names_unique(std::vector<PlannedScene>& scenes) {
    std::set<std::string> names;
    for (PlannedScene& planned : scenes) {
        const std::string name = planned.results.name;
        for (int number = 2; !names.insert(planned.results.name).second; ++number)
            planned.results.name = fmt::format("{}-{}", name, number);
    }
}

} // namespace tristim
