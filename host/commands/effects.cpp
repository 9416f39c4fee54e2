#include "commands/effects.h"

#include "commands/render_arguments.h"
#include "render/kernel_macros.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>

namespace tristim {
namespace {

struct EffectsCommand {
    RenderArguments arguments;
    bool json = false;
};

/// What a render of a scene is made of.
struct RenderPlan {
    RenderOptions options;
    std::vector<EffectReason> reasons;
    Effects effects;
    std::vector<std::string> files;
    Macros macros;
    WavelengthLayout layout;
    ItemBytes bytes;
    int bvh_width = 0;
};

/// No device is opened unless one is named: the others' kernels are those of the table's default row.
DeviceTuning tuning_of(const std::string& device) {
    return device.empty() ? DeviceTuning{} : open_device(device).tuning;
}

RenderPlan make_plan(const RenderArguments& arguments) {
    const Scene scene = load_scene(arguments.scene, arguments.rgb_upsampling);
    RenderPlan plan;
    plan.options = resolve_options(arguments, scene);
    const RenderOptions& options = plan.options;
    const DeviceTuning tuning = tuning_of(arguments.device);
    plan.reasons = effect_reasons(scene, options.photon_roughness);
    plan.effects = united(derive_effects(scene, options.photon_roughness), options.more_effects);
    const FlatScene flat = flatten_scene(scene, plan.effects, options.width, options.height, options.region);
    plan.bvh_width = tuning.bvh_width;
    plan.files = kernel_files(flat);
    plan.macros = kernel_macros(options, plan.effects, build_bvh(flat.soup, tuning.bvh_width), tuning);
    plan.layout = wavelength_layout(options.method);
    plan.bytes = item_bytes(plan.effects, plan.layout);
    return plan;
}

std::size_t row_bytes(int rows, int width) {
    return sizeof(float) * static_cast<std::size_t>(rows) * static_cast<std::size_t>(width);
}

nlohmann::ordered_json to_json(const RenderPlan& plan, const std::string& scene) {
    nlohmann::ordered_json json{{"scene", scene},
                                {"method", plan.options.method.name()},
                                {"resolution", {plan.options.width, plan.options.height}},
                                {"photons_per_pass", plan.options.photons_per_pass}};
    for (const EffectKind& kind : effect_table()) {
        auto reasons = nlohmann::ordered_json::array();
        for (const EffectReason& reason : plan.reasons) {
            if (reason.effect == kind.flag)
                reasons.push_back({{"what", reason.what}, {"where", reason.where.text()}});
        }
        json["effects"][kind.name] = {
            {"on", plan.effects.*kind.flag}, {"meaning", kind.meaning}, {"macro", kind.macro}, {"reasons", reasons}};
    }
    json["coloured_camera_paths"] = has_coloured_eye(plan.effects);
    json["photons_hold"] = stores_spectral_flux(plan.effects) ? "spectrum" : "xyz";
    json["paths_keep_a_slot"] = plan.effects.dispersion;
    json["wavelengths"] = {{"w", plan.layout.w},
                           {"lanes", plan.layout.lanes},
                           {"blocks", plan.layout.blocks},
                           {"padding", plan.layout.padded() - plan.layout.w}};
    json["bytes"] = {{"pixel", plan.bytes.pixel},
                     {"photon", plan.bytes.photon},
                     {"bvh_node", row_bytes(BVH_NODE_ROWS, plan.bvh_width)},
                     {"bvh_leaf", row_bytes(BVH_LEAF_ROWS, plan.bvh_width)}};
    json["kernels"] = plan.files;
    for (const auto& [name, value] : plan.macros)
        json["macros"][name] = value;
    return json;
}

/// Words with spaces between, in lines of at most `width` columns that begin with `indent`.
std::string wrapped(const std::vector<std::string>& words, const std::string& indent, std::size_t width) {
    std::string text, line = indent;
    for (const std::string& word : words) {
        if (line.size() > indent.size() && line.size() + 1 + word.size() > width) {
            text += line + "\n";
            line = indent;
        }
        line += (line.size() > indent.size() ? " " : "") + word;
    }
    return text + line + "\n";
}

std::vector<std::string> reason_lines(const RenderPlan& plan, const EffectKind& kind) {
    constexpr std::size_t most = 3;
    std::vector<std::string> lines;
    std::size_t left_out = 0;
    for (const EffectReason& reason : plan.reasons) {
        if (reason.effect != kind.flag)
            continue;
        const std::string where = reason.where.text();
        if (lines.size() < most)
            lines.push_back(where.empty() ? reason.what : fmt::format("{} ({})", reason.what, where));
        else
            ++left_out;
    }
    if (left_out > 0)
        lines.push_back(fmt::format("and {} more", left_out));
    if (lines.empty())
        lines.emplace_back("--effects, not the scene");
    return lines;
}

void print_effects(const RenderPlan& plan) {
    constexpr const char* row = "{:<17}{:<48}{}\n";
    fmt::print(row, "effect", "what it is", "what calls for it");
    std::vector<std::string> off;
    for (const EffectKind& kind : effect_table()) {
        if (!(plan.effects.*kind.flag)) {
            off.emplace_back(kind.name);
            continue;
        }
        const std::vector<std::string> lines = reason_lines(plan, kind);
        for (std::size_t i = 0; i < lines.size(); ++i)
            fmt::print(row, i == 0 ? kind.name : "", i == 0 ? kind.meaning : "", lines[i]);
    }
    if (!off.empty())
        fmt::print("\nOff, and left out of the kernels:\n{}", wrapped(off, "  ", 120));
}

void print_consequences(const RenderPlan& plan) {
    const auto line = [](const char* name, const std::string& text) { fmt::print("{:<17}{}\n", name, text); };
    const WavelengthLayout& layout = plan.layout;
    const int padding = layout.padded() - layout.w;
    fmt::print("\n");
    line("wavelengths",
         fmt::format("W = {} a pass, in {} vector{} of {} floats, {} of {} padding", layout.w, layout.blocks,
                     layout.blocks == 1 ? "" : "s", layout.lanes, padding == 0 ? "none" : std::to_string(padding),
                     padding == 1 ? "which is" : "them"));
    line("camera paths", has_coloured_eye(plan.effects)
                             ? "carry W throughputs, since surfaces on their way may colour them"
                             : "carry one throughput for all wavelengths, since nothing on their way colours them");
    line("photons", stores_spectral_flux(plan.effects)
                        ? "hold W fluxes beside X, Y and Z, since camera paths may depend on the wavelength"
                        : "hold three bins, X, Y and Z, since no camera path depends on the wavelength");
    line("slots", plan.effects.dispersion
                      ? "a path that meets a surface with dispersion goes on with one of the W wavelengths, its slot"
                      : "every path carries all wavelengths to its end");
    line("memory", fmt::format("{} bytes a pixel, {} a photon, {} a BVH node ({} children), {} a leaf ({} triangles)",
                               plan.bytes.pixel, plan.bytes.photon, row_bytes(BVH_NODE_ROWS, plan.bvh_width),
                               plan.bvh_width, row_bytes(BVH_LEAF_ROWS, plan.bvh_width), plan.bvh_width));
    std::vector<std::string> defines;
    for (const auto& [name, value] : plan.macros)
        defines.push_back(fmt::format("{}={}", name, value));
    line("kernels", fmt::format("{}", fmt::join(plan.files, ", ")));
    fmt::print("\nEach of them is built with these macros (explained in kernels/config.h):\n{}",
               wrapped(defines, "  ", 120));
}

void run(const EffectsCommand& command) {
    const RenderPlan plan = make_plan(command.arguments);
    if (command.json) {
        fmt::print("{}\n", to_json(plan, command.arguments.scene).dump(2));
        return;
    }
    fmt::print("{} by {} at {}x{}, {} photon paths a pass\n\n", command.arguments.scene, plan.options.method.name(),
               plan.options.width, plan.options.height, plan.options.photons_per_pass);
    print_effects(plan);
    print_consequences(plan);
}

} // namespace

void add_effects_command(CLI::App& app) {
    auto command = std::make_shared<EffectsCommand>();
    CLI::App* sub = app.add_subcommand("effects", "Tell which effects a scene calls for, why, and what that builds");
    add_render_arguments(*sub, command->arguments);
    sub->add_flag("--json", command->json, "Print JSON");
    sub->callback([command] { run(*command); });
}

} // namespace tristim
