#include "render/identity.h"

#include "opencl/program.h"
#include "render/effects.h"
#include "render/scene_identity.h"

#include <algorithm>
#include <fmt/ranges.h>
#include <set>

namespace tristim {
namespace {

std::string corners(const Region& r) {
    return fmt::format("{},{},{},{}", r.x, r.y, r.x + r.width, r.y + r.height);
}

/// Of what a hash stands for, that it differs is all that can be told.
std::string clause(const std::string& name, const std::string& is, const std::string& wanted) {
    if (name == "scene")
        return "it shows another scene (geometry, materials, lights or how RGB colours become spectra)";
    if (name == "camera")
        return "its camera is another one";
    if (name == "kernels")
        return "it was rendered with other kernels, of another build of tristim or by --kernels";
    return fmt::format("it was rendered with {} {}, not {}", name, is.empty() ? "unknown" : is,
                       wanted.empty() ? "unknown" : wanted);
}

/// What is compiled in beside what the scene calls for.
std::string extra_effects(const Scene& scene, const RenderOptions& options) {
    const Effects called_for = derive_effects(scene, options.photon_roughness);
    std::vector<std::string> names;
    for (const EffectKind& kind : effect_table()) {
        if (options.more_effects.*kind.flag && !(called_for.*kind.flag))
            names.emplace_back(kind.name);
    }
    return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ","));
}

} // namespace

RenderIdentity render_identity(const Scene& scene, const RenderOptions& options) {
    const SceneIdentity content = scene_identity(scene, options);
    return {{"version", TRISTIM_VERSION},
            {"kernels", hash_kernel_sources(options.kernels)},
            {"scene", content.scene},
            {"resolution", fmt::format("{}x{}", options.width, options.height)},
            {"region", corners(options.region)},
            {"camera", content.camera},
            {"method", method_name(options)},
            {"sequence", sequence_name(options)},
            {"seed", fmt::format("{}", options.seed)},
            {"photons per pass", fmt::format("{}", options.photons_per_pass)},
            {"maximum depth", fmt::format("{}", options.max_depth)},
            {"radius", options.statistics_radius ? "statistics" : "global"},
            {"initial radius", options.radius ? fmt::format("{}", *options.radius) : "auto"},
            {"radius factor", fmt::format("{}", options.radius_factor)},
            {"alpha", fmt::format("{}", options.alpha)},
            {"direct light", options.direct_photons ? "photons" : "sample"},
            {"photon roughness", fmt::format("{}", options.photon_roughness)},
            {"math", options.fast_math ? "fast" : "precise"},
            {"extra effects", extra_effects(scene, options)}}; // they may round otherwise
}

std::string value_of(const RenderIdentity& identity, const std::string& name) {
    const auto found =
        std::find_if(identity.begin(), identity.end(), [&](const auto& entry) { return entry.first == name; });
    return found == identity.end() ? "" : found->second;
}

std::string describe_difference(const RenderIdentity& is, const RenderIdentity& wanted) {
    std::vector<std::string> names;
    for (const RenderIdentity* identity : {&wanted, &is}) {
        for (const auto& entry : *identity) {
            if (std::find(names.begin(), names.end(), entry.first) == names.end())
                names.push_back(entry.first);
        }
    }
    std::set<std::string> differ;
    for (const std::string& name : names) {
        if (value_of(is, name) != value_of(wanted, name))
            differ.insert(name);
    }
    if (differ.contains("resolution")) { // which the others follow
        differ.erase("region");
        differ.erase("camera");
    }
    std::vector<std::string> clauses;
    for (const std::string& name : names) {
        if (differ.contains(name))
            clauses.push_back(clause(name, value_of(is, name), value_of(wanted, name)));
    }
    return fmt::format("{}", fmt::join(clauses, "; "));
}

} // namespace tristim
