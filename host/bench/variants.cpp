#include "bench/variants.h"

#include "base/error.h"
#include "base/split.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tristim {
namespace {

VariantGroup wavelength_costs(const RenderOptions& base) {
    VariantGroup group{"wavelengths", "Wavelengths per path: N sets of three", {}, 0};
    for (const int sets : {1, 2, 4, 8, 20, 40}) {
        RenderOptions options = base;
        options.method = {Method::Kind::Tristimulus, sets};
        group.variants.push_back({options.method.name(), options});
    }
    return group;
}

VariantGroup photon_costs(const RenderOptions& base) {
    VariantGroup group{"photons", "Photon paths per pass", {}, 0};
    for (const double factor : {1.0 / 16.0, 0.25, 1.0, 4.0}) {
        RenderOptions options = base;
        options.photons_per_pass = std::max(1, static_cast<int>(std::lround(factor * base.photons_per_pass)));
        if (factor == 1.0)
            group.baseline = group.variants.size();
        group.variants.push_back({fmt::format("{} photons", options.photons_per_pass), options});
    }
    return group;
}

VariantGroup radius_costs(const RenderOptions& base) {
    VariantGroup group{"radius", "Initial search radius", {}, 0};
    for (const double factor : {0.25, 0.5, 1.0, 2.0}) {
        RenderOptions options = base;
        options.radius_factor = factor * base.radius_factor;
        if (factor == 1.0)
            group.baseline = group.variants.size();
        group.variants.push_back({fmt::format("radius \u00d7 {}", options.radius_factor), options});
    }
    return group;
}

VariantGroup alpha_costs(const RenderOptions& base) {
    VariantGroup group{"alpha", "Alpha: how slowly the radius shrinks", {}, 0};
    std::vector<double> alphas{0.5, 0.8, 0.9, base.alpha};
    std::sort(alphas.begin(), alphas.end());
    alphas.erase(std::unique(alphas.begin(), alphas.end()), alphas.end());
    for (const double alpha : alphas) {
        RenderOptions options = base;
        options.alpha = alpha;
        if (alpha == base.alpha)
            group.baseline = group.variants.size();
        group.variants.push_back({fmt::format("alpha {:.3g}", alpha), options});
    }
    return group;
}

/// Two settings of one switch, the base's own as baseline.
VariantGroup switch_costs(const RenderOptions& base, const char* name, const char* title, bool RenderOptions::*member,
                          std::array<const char*, 2> labels) {
    VariantGroup group{name, title, {}, base.*member ? std::size_t{1} : std::size_t{0}};
    for (const bool on : {false, true}) {
        RenderOptions options = base;
        options.*member = on;
        group.variants.push_back({labels[on ? 1 : 0], options});
    }
    return group;
}

} // namespace

VariantGroup method_variants(const std::string& methods, const RenderOptions& base) {
    VariantGroup group{"methods", "Methods", {}, 0};
    for (const std::string& word : split(methods, ',')) {
        const std::size_t at = word.find('@');
        const std::string sequence = at == std::string::npos ? "" : word.substr(at + 1);
        if (at != std::string::npos && sequence != "random" && sequence != "stratified")
            fail("bad sequence '{}' in --methods: expected random or stratified after the @", sequence);
        RenderOptions options = base;
        options.auto_method = word.substr(0, at) == "auto";
        if (!options.auto_method)
            options.method = parse_method(word.substr(0, at));
        if (!sequence.empty())
            options.random_sequence = sequence == "random";
        const std::string label = method_name(options) + (sequence.empty() ? "" : " " + sequence);
        const bool twice = std::any_of(group.variants.begin(), group.variants.end(), [&](const Variant& other) {
            return options_json(other.options) == options_json(options);
        });
        if (twice)
            fail("method '{}' comes twice in --methods", word);
        group.variants.push_back({label, options});
    }
    return group;
}

std::vector<VariantGroup> cost_variants(const RenderOptions& base) {
    return {wavelength_costs(base),
            photon_costs(base),
            radius_costs(base),
            alpha_costs(base),
            switch_costs(base, "math", "Arithmetic", &RenderOptions::fast_math, {"precise math", "fast math"}),
            switch_costs(base, "radius-rule", "Radius rule", &RenderOptions::statistics_radius,
                         {"global radius", "statistics radius"}),
            switch_costs(base, "direct", "Direct light", &RenderOptions::direct_photons,
                         {"sampled lights", "photons only"})};
}

nlohmann::ordered_json options_json(const RenderOptions& options) {
    nlohmann::ordered_json json{{"method", method_name(options)},
                                {"sequence", sequence_name(options)},
                                {"photons_per_pass", options.photons_per_pass},
                                {"max_depth", options.max_depth}};
    if (options.radius)
        json["initial_radius"] = *options.radius;
    else
        json["initial_radius"] = "auto";
    json["radius_factor"] = options.radius_factor;
    json["alpha"] = options.alpha;
    json["radius"] = options.statistics_radius ? "statistics" : "global";
    json["direct"] = options.direct_photons ? "photons" : "sample";
    json["photon_roughness"] = options.photon_roughness;
    json["math"] = options.fast_math ? "fast" : "precise";
    return json;
}

} // namespace tristim
