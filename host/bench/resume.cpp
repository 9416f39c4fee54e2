#include "bench/resume.h"

#include "base/error.h"

namespace tristim {

void take_over(BenchPlan& plan, const BenchResults& earlier, const std::string& source) {
    const auto require = [&](bool same, const std::string& what) {
        if (!same)
            fail("cannot go on with \"{}\": it is a bench with other {}", source, what);
    };
    const BenchResults& wanted = plan.results;
    require(earlier.kind == wanted.kind, "aims (--costs)");
    require(earlier.version == wanted.version, "kernels: version " + earlier.version);
    require(earlier.seconds == wanted.seconds, fmt::format("--time: {}", earlier.seconds));
    require(earlier.repeats == wanted.repeats, fmt::format("--repeats: {}", earlier.repeats));
    require(earlier.seed == wanted.seed, fmt::format("--seed: {}", earlier.seed));
    require(earlier.devices == wanted.devices, "devices or drivers");
    require(earlier.scenes.size() == plan.scenes.size(), "scenes");
    for (std::size_t s = 0; s < earlier.scenes.size(); ++s) {
        const SceneResults& from = earlier.scenes[s];
        SceneResults& to = plan.scenes[s].results;
        require(from.name == to.name && from.runs.size() == to.runs.size() && from.groups.size() == to.groups.size(),
                "scenes or methods");
        require(from.width == to.width && from.height == to.height, "--resolution");
        require(from.regions == to.regions, "regions");
        require(from.reference.passes == 0 || from.reference.file == reference_name(plan.scenes[s]),
                "--reference: " + from.reference.file);
        require(from.reference.passes == 0 || !plan.scenes[s].given_reference.empty() ||
                    from.reference.method == plan.scenes[s].reference_options.method.name(),
                "--reference-method: " + from.reference.method);
        for (std::size_t r = 0; r < to.runs.size(); ++r)
            require(from.runs[r].options == to.runs[r].options && from.runs[r].id == to.runs[r].id,
                    "methods or options");
        to.runs = from.runs;
        to.reference = from.reference;
        to.image = from.image;
        to.error_map_scale = from.error_map_scale;
        for (std::size_t g = 0; g < to.groups.size(); ++g)
            to.groups[g].notes = from.groups[g].notes;
    }
    plan.results.started = earlier.started;
    plan.results.peak_process_memory = earlier.peak_process_memory;
}

} // namespace tristim
