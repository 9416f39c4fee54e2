// What a bench renders: variants of methods and settings, their runs, and names.
#include "bench/plan.h"
#include "scene_folder.h"
#include "test_scenes.h"

#include <algorithm>
#include <map>
#include <set>

namespace tristim::test {
namespace {

RenderOptions base_options() {
    RenderOptions options = small_render("tristimulus:1", 16, 12, 1024, 0.25, 7);
    options.seed = 5;
    return options;
}

std::vector<std::string> labels_of(const VariantGroup& group) {
    std::vector<std::string> labels;
    for (const Variant& variant : group.variants)
        labels.push_back(variant.label);
    return labels;
}

/// Names of the options in which two differ.
std::vector<std::string> differing(const RenderOptions& a, const RenderOptions& b) {
    const auto json_a = options_json(a);
    const auto json_b = options_json(b);
    std::vector<std::string> names;
    for (const auto& [name, value] : json_a.items()) {
        if (json_b.at(name) != value)
            names.push_back(name);
    }
    EXPECT_EQ(json_a.size(), json_b.size());
    return names;
}

/// A change of any option that shapes a pass shows in options_json, or equal runs would be taken for one.
TEST(BenchPlan, OptionsJsonTellsAllThatShapesAPass) {
    const RenderOptions base = base_options();
    const auto expect_change = [&](const char* name, const std::function<void(RenderOptions&)>& change) {
        RenderOptions options = base;
        change(options);
        EXPECT_EQ(differing(base, options), std::vector<std::string>{name});
    };
    expect_change("method", [](RenderOptions& o) { o.method = parse_method("rgb"); });
    expect_change("sequence", [](RenderOptions& o) { o.random_sequence = true; });
    expect_change("photons_per_pass", [](RenderOptions& o) { o.photons_per_pass = 1025; });
    expect_change("max_depth", [](RenderOptions& o) { o.max_depth = 8; });
    expect_change("initial_radius", [](RenderOptions& o) { o.radius = 0.5; });
    expect_change("initial_radius", [](RenderOptions& o) { o.radius.reset(); });
    expect_change("radius_factor", [](RenderOptions& o) { o.radius_factor = 2.0; });
    expect_change("alpha", [](RenderOptions& o) { o.alpha = 0.5; });
    expect_change("radius", [](RenderOptions& o) { o.statistics_radius = true; });
    expect_change("direct", [](RenderOptions& o) { o.direct_photons = true; });
    expect_change("photon_roughness", [](RenderOptions& o) { o.photon_roughness = 0.3; });
    expect_change("math", [](RenderOptions& o) { o.fast_math = true; });
    RenderOptions other_seed = base;
    other_seed.seed = 6;
    EXPECT_EQ(differing(base, other_seed), std::vector<std::string>{});
}

TEST(BenchPlan, MethodsBecomeVariantsInTheirOrder) {
    const RenderOptions base = base_options();
    const VariantGroup group =
        method_variants("rgb,spectral:400,tristimulus:20,tristimulus:1@random,tristimulus:1@stratified", base);
    EXPECT_EQ(labels_of(group), (std::vector<std::string>{"rgb", "spectral:400", "tristimulus:20",
                                                          "tristimulus:1 random", "tristimulus:1 stratified"}));
    EXPECT_EQ(group.baseline, 0U);
    const auto& variants = group.variants;
    EXPECT_EQ(differing(base, variants[0].options), std::vector<std::string>{"method"});
    EXPECT_EQ(variants[2].options.method.name(), "tristimulus:20");
    EXPECT_EQ(differing(base, variants[3].options), std::vector<std::string>{"sequence"});
    EXPECT_TRUE(variants[3].options.random_sequence);
    EXPECT_EQ(differing(base, variants[4].options), std::vector<std::string>{});
    for (const Variant& variant : variants)
        EXPECT_EQ(variant.options.seed, base.seed);

    RenderOptions random = base;
    random.random_sequence = true;
    const VariantGroup mixed = method_variants("rgb,rgb@stratified", random);
    EXPECT_TRUE(mixed.variants[0].options.random_sequence) << "the base's own";
    EXPECT_FALSE(mixed.variants[1].options.random_sequence);
}

TEST(BenchPlan, BadMethodsAreRefused) {
    const auto refused = [](const char* methods, const std::string& words) {
        expect_message(error_of([&] { method_variants(methods, base_options()); }), "", words);
    };
    refused("rgb,spectrum", "unknown method 'spectrum'");
    refused("tristimulus:0", "bad method 'tristimulus:0'");
    refused("", "unknown method ''");
    refused("rgb,", "unknown method ''");
    refused(",rgb", "unknown method ''");
    refused("rgb, spectral:400", "unknown method ' spectral:400'");
    refused("rgb@", "bad sequence ''");
    refused("rgb@golden", "bad sequence 'golden'");
    refused("rgb@random@random", "bad sequence 'random@random'");
    refused("rgb,tristimulus:1,rgb", "method 'rgb' comes twice");
    refused("tristimulus:1,tristimulus:1@stratified", "method 'tristimulus:1@stratified' comes twice");
}

TEST(BenchPlan, CostsTurnOneOptionAtATime) {
    const std::map<std::string, std::string> turned{
        {"wavelengths", "method"}, {"photons", "photons_per_pass"}, {"radius", "radius_factor"}, {"alpha", "alpha"},
        {"math", "math"},          {"radius-rule", "radius"},       {"direct", "direct"}};
    for (const bool other_base : {false, true}) {
        RenderOptions base = base_options();
        if (other_base) {
            base.alpha = 0.8;
            base.fast_math = true;
            base.radius_factor = 3.0;
        }
        std::set<std::string> names;
        for (const VariantGroup& group : cost_variants(base)) {
            ASSERT_TRUE(turned.contains(group.name)) << group.name;
            EXPECT_TRUE(names.insert(group.name).second);
            EXPECT_FALSE(group.title.empty());
            ASSERT_LT(group.baseline, group.variants.size());
            EXPECT_GE(group.variants.size(), 2U);
            const std::vector<std::string> labels = labels_of(group);
            EXPECT_EQ(std::set<std::string>(labels.begin(), labels.end()).size(), labels.size()) << group.name;
            for (std::size_t i = 0; i < group.variants.size(); ++i) {
                const bool is_baseline = i == group.baseline;
                EXPECT_EQ(differing(base, group.variants[i].options),
                          is_baseline ? std::vector<std::string>{} : std::vector{turned.at(group.name)})
                    << group.name << ": " << group.variants[i].label;
                EXPECT_EQ(group.variants[i].options.width, base.width);
                EXPECT_EQ(group.variants[i].options.seed, base.seed);
                EXPECT_NO_THROW(check_options(group.variants[i].options));
            }
        }
        EXPECT_EQ(names.size(), turned.size());
    }
}

TEST(BenchPlan, CostsTakeTheNumbersOfSetsThatTheyPromise) {
    const std::vector<VariantGroup> groups = cost_variants(base_options());
    EXPECT_EQ(labels_of(groups.at(0)), (std::vector<std::string>{"tristimulus:1", "tristimulus:2", "tristimulus:4",
                                                                 "tristimulus:8", "tristimulus:20", "tristimulus:40"}));
}

PlannedScene plan(const std::string& file, const std::vector<VariantGroup>& groups) {
    return plan_scene(Scene{}, file, groups, {test_device()}, {{"image", {0, 0, 16, 12}}});
}

TEST(BenchPlan, GroupsShareEqualRuns) {
    const std::vector<VariantGroup> groups = cost_variants(base_options());
    std::size_t variants = 0;
    for (const VariantGroup& group : groups)
        variants += group.variants.size();
    const PlannedScene planned = plan("a/scene.pbrt", groups);
    const SceneResults& results = planned.results;
    EXPECT_EQ(results.runs.size(), variants - (groups.size() - 1)) << "all groups hold the base";
    EXPECT_EQ(planned.options.size(), results.runs.size());
    ASSERT_EQ(results.groups.size(), groups.size());
    std::set<std::string> ids;
    for (std::size_t i = 0; i < results.runs.size(); ++i) {
        EXPECT_EQ(results.runs[i].options, options_json(planned.options[i]));
        EXPECT_TRUE(ids.insert(results.runs[i].id).second);
        EXPECT_EQ(results.runs[i].id.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                                       "0123456789-_."),
                  std::string::npos)
            << results.runs[i].id;
    }
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const RunGroup& group = results.groups[g];
        EXPECT_EQ(group.name, groups[g].name);
        EXPECT_EQ(group.labels, labels_of(groups[g]));
        EXPECT_EQ(group.baseline, results.groups[0].baseline) << "the same run in all";
        ASSERT_EQ(group.runs.size(), groups[g].variants.size());
        for (std::size_t i = 0; i < group.runs.size(); ++i)
            EXPECT_EQ(results.runs.at(group.runs[i]).options, options_json(groups[g].variants[i].options));
    }
    EXPECT_EQ(results.width, 16);
    EXPECT_EQ(results.height, 12);
}

TEST(BenchPlan, EveryDeviceHasItsRuns) {
    Device first = test_device();
    Device second = test_device();
    first.info.name = "first";
    second.info.name = "second";
    const PlannedScene planned =
        plan_scene(Scene{}, "a/scene.pbrt", {method_variants("rgb,tristimulus:1", base_options())},
                   {first, second, first}, {{"image", {0, 0, 16, 12}}});
    const SceneResults& results = planned.results;
    std::vector<std::string> labels;
    std::set<std::string> ids;
    for (std::size_t i = 0; i < results.runs.size(); ++i) {
        EXPECT_EQ(results.runs[i].device, i / 2);
        labels.push_back(results.runs[i].label);
        ids.insert(results.runs[i].id);
    }
    EXPECT_EQ(labels,
              (std::vector<std::string>{"rgb on first (1)", "tristimulus:1 on first (1)", "rgb on second",
                                        "tristimulus:1 on second", "rgb on first (2)", "tristimulus:1 on first (2)"}));
    EXPECT_EQ(ids.size(), labels.size());
    ASSERT_EQ(results.groups.size(), 1U);
    EXPECT_EQ(results.groups[0].labels, labels);
    EXPECT_EQ(results.groups[0].runs, (std::vector<std::size_t>{0, 1, 2, 3, 4, 5}));
    EXPECT_EQ(results.groups[0].baseline, 0U);
}

TEST(BenchPlan, ScenesHaveNamesOfTheirOwn) {
    const std::vector<VariantGroup> groups{method_variants("rgb", base_options())};
    EXPECT_EQ(plan("meshes/dispersion/scene.pbrt", groups).results.name, "dispersion");
    EXPECT_EQ(plan("meshes/interference/areas-a.pbrt", groups).results.name, "interference-areas-a");
    EXPECT_EQ(plan("/a b/c,d/é.pbrt", groups).results.name, "c-d---");
    EXPECT_EQ(plan("/scene.pbrt", groups).results.name, "scene");

    std::vector<PlannedScene> scenes;
    for (const char* file : {"a/x/scene.pbrt", "b/x/scene.pbrt", "y/scene.pbrt", "x/2.pbrt", "c/x/scene.pbrt"})
        scenes.push_back(plan(file, groups));
    make_names_unique(scenes);
    std::vector<std::string> names;
    for (const PlannedScene& scene : scenes)
        names.push_back(scene.results.name);
    EXPECT_EQ(names, (std::vector<std::string>{"x", "x-2", "y", "x-2-2", "x-3"}));
}

} // namespace
} // namespace tristim::test
