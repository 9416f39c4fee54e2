#include "render/stats_json.h"

namespace tristim {

nlohmann::ordered_json stats_json(const RenderOptions& options, const RenderOutcome& outcome, const std::string& scene,
                                  double load_seconds, const ErrorEstimate& estimate) {
    const RenderStatistics& statistics = outcome.statistics;
    const RayTotals& rays = outcome.sums.rays;

    nlohmann::ordered_json json;
    json["version"] = TRISTIM_VERSION;
    json["scene"] = scene;
    json["method"] = options.method.name();
    json["sequence"] = sequence_name(options);
    for (const DeviceShare& share : outcome.shares) {
        json["devices"].push_back({{"name", share.device.name},
                                   {"platform", share.device.platform},
                                   {"driver", share.device.driver},
                                   {"passes", share.passes},
                                   {"seconds", share.seconds},
                                   {"failure", share.failure}});
        if (outcome.shares.back().rank > 0)
            json["devices"].back()["rank"] = share.rank;
    }
    json["resolution"] = {options.width, options.height};
    json["region"] = {options.region.x, options.region.y, options.region.x + options.region.width,
                      options.region.y + options.region.height};
    json["seed"] = options.seed;
    json["passes"] = statistics.passes;
    json["photons_per_pass"] = options.photons_per_pass;
    auto& seconds = json["seconds"];
    seconds["load"] = load_seconds;
    seconds["bvh"] = statistics.bvh_seconds;
    seconds["build_kernels"] = statistics.build_kernels_seconds;
    seconds["pilot"] = statistics.pilot_seconds;
    seconds["render"] = statistics.render_seconds;
    for (std::size_t step = 0; step < step_names.size(); ++step)
        seconds["steps"][step_names[step]] = statistics.step_seconds[step];
    json["rays"] = {{"camera", rays.camera}, {"shadow", rays.shadow}, {"photon", rays.photon}};
    json["photons_emitted"] = statistics.photons_emitted;
    json["photons_stored"] = statistics.photons_stored;
    json["bytes_per_pixel"] = statistics.bytes_per_pixel;
    json["bytes_per_photon"] = statistics.bytes_per_photon;
    for (const auto& [name, bytes] : statistics.buffer_bytes)
        json["bytes"][name] = bytes;
    if (estimate.complete)
        json["estimated_error"] = {{"rmse", estimate.rmse}, {"noise", estimate.noise}, {"bias", estimate.bias}};
    else
        json["noise_at_most"] = estimate.noise;
    const NonFiniteCounts& counts = outcome.sums.non_finite;
    json["non_finite_samples"] = counts.total();
    json["non_finite"] = {
        {"eye", counts.eye}, {"photon", counts.photon}, {"gather", counts.gather}, {"film", counts.film}};
    return json;
}

} // namespace tristim
