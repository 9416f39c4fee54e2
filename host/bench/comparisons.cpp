#include "bench/comparisons.h"

#include "image/compare_images.h"
#include "image/error_map.h"
#include "image/write_image.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace tristim {
namespace {

constexpr std::uint32_t math_passes = 16;
constexpr const char* choice_note = "Chosen for";

/// Seconds of a pass, over all repeats.
double pass_seconds(const Run& run) {
    double seconds = 0.0;
    double passes = 0.0;
    for (const Repeat& repeat : run.repeats) {
        seconds += repeat.checkpoints.back().seconds;
        passes += static_cast<double>(repeat.checkpoints.back().passes);
    }
    return seconds / passes;
}

} // namespace

void write_images(SceneResults& scene, const std::vector<Contestant>& contestants, const XyzImage& reference,
                  const std::string& folder) {
    const auto path = [&](const std::string& name) { return (std::filesystem::path(folder) / name).string(); };
    std::vector<XyzImage> images;
    std::vector<std::vector<float>> errors;
    for (const Contestant& contestant : contestants) {
        images.push_back(contestant.image());
        errors.push_back(pixel_errors(images.back(), reference));
    }
    scene.error_map_scale = error_map_scale(errors);
    const ToneCurve curve(reference, {});
    for (std::size_t i = 0; i < images.size(); ++i) {
        Run& run = scene.runs[i];
        const std::string name = "images/" + scene.name + "-" + run.id;
        run.image = name + ".png";
        run.error_map = name + "-error.png";
        write_png(path(run.image), images[i], curve);
        write_error_map(path(run.error_map), images[i], reference, scene.error_map_scale);
    }
}

void note_choices(SceneResults& scene) {
    for (RunGroup& group : scene.groups) {
        std::erase_if(group.notes, [](const std::string& note) { return note.starts_with(choice_note); });
        for (std::size_t i = 0; i < group.runs.size(); ++i) {
            const Run& run = scene.runs[group.runs[i]];
            if (run.options.value("method", "") != "auto")
                continue;
            std::vector<std::string> choices;
            for (const Repeat& repeat : run.repeats)
                choices.push_back(fmt::format("{} (in {:.2g} s)", repeat.method, repeat.trial_seconds));
            group.notes.push_back(
                fmt::format("{} {} by trial passes: {}.", choice_note, group.labels[i], fmt::join(choices, ", ")));
        }
    }
}

void compare_math(PlannedScene& planned, DeviceScenes& scenes, const std::vector<Device>& devices, std::uint32_t seed) {
    const auto group = std::find_if(planned.results.groups.begin(), planned.results.groups.end(),
                                    [](const RunGroup& g) { return g.name == "math"; });
    if (group == planned.results.groups.end() || !group->notes.empty())
        return;
    const std::size_t precise = group->runs[0];
    const std::size_t fast = group->runs[1];
    std::vector<XyzImage> images;
    for (const std::size_t run : {precise, fast}) {
        RenderOptions options = planned.options[run];
        options.seed = seed;
        const Device& device = devices[planned.results.runs[run].device];
        Renderer renderer(scenes.get(options, device), options, device);
        for (std::uint32_t pass = 0; pass < math_passes; ++pass)
            renderer.render_pass(pass);
        images.push_back(xyz_image(renderer.film()));
    }
    group->notes.push_back(
        fmt::format("After the same {} passes the image of fast math differs from that of precise "
                    "math by an RMSE of {:.2g}; a pass of fast math takes {:.2f} times as long.",
                    math_passes, compare_images(images[1], images[0]).rmse,
                    pass_seconds(planned.results.runs[fast]) / pass_seconds(planned.results.runs[precise])));
}

} // namespace tristim
