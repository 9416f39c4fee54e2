#include "mpi/rank_outcome.h"

#include <nlohmann/json.hpp>

namespace tristim {

std::string counts_text(const RenderSums& sums, const PassRanges& missing) {
    const RayTotals& rays = sums.rays;
    const NonFiniteCounts& bad = sums.non_finite;
    nlohmann::json ranges = nlohmann::json::array();
    for (const PassRanges::Range& range : missing.ranges())
        ranges.push_back({range.begin, range.end});
    return nlohmann::json{{"missing", ranges},
                          {"rays", {rays.camera, rays.shadow, rays.photon}},
                          {"non_finite", {bad.eye, bad.photon, bad.gather, bad.film}},
                          {"photons_stored", sums.photons_stored}}
        .dump();
}

void add_counts(const std::string& text, RenderSums& sums) {
    const nlohmann::json json = nlohmann::json::parse(text);
    const auto& rays = json["rays"];
    const auto& bad = json["non_finite"];
    PassRanges missing;
    for (const nlohmann::json& range : json["missing"])
        missing.add({range[0].get<std::uint32_t>(), range[1].get<std::uint32_t>()});
    sums.passes = sums.passes.without(missing);
    sums.photons_stored += json["photons_stored"].get<std::uint64_t>();
    sums.rays.camera += rays[0].get<std::uint64_t>();
    sums.rays.shadow += rays[1].get<std::uint64_t>();
    sums.rays.photon += rays[2].get<std::uint64_t>();
    sums.non_finite.eye += bad[0].get<std::uint64_t>();
    sums.non_finite.photon += bad[1].get<std::uint64_t>();
    sums.non_finite.gather += bad[2].get<std::uint64_t>();
    sums.non_finite.film += bad[3].get<std::uint64_t>();
}

std::string outcome_text(const RenderOutcome& outcome) {
    const RenderStatistics& statistics = outcome.statistics;
    nlohmann::json json{{"bvh", statistics.bvh_seconds},
                        {"build_kernels", statistics.build_kernels_seconds},
                        {"pilot", statistics.pilot_seconds},
                        {"steps", statistics.step_seconds},
                        {"shares", nlohmann::json::array()}};
    for (const DeviceShare& share : outcome.shares) {
        json["shares"].push_back({{"name", share.device.name},
                                  {"platform", share.device.platform},
                                  {"driver", share.device.driver},
                                  {"passes", share.passes},
                                  {"seconds", share.seconds},
                                  {"failure", share.failure}});
    }
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void add_outcome(const std::string& text, int rank, RenderOutcome& outcome) {
    const nlohmann::json json = nlohmann::json::parse(text);
    RenderStatistics statistics;
    json["bvh"].get_to(statistics.bvh_seconds);
    json["build_kernels"].get_to(statistics.build_kernels_seconds);
    json["pilot"].get_to(statistics.pilot_seconds);
    json["steps"].get_to(statistics.step_seconds);
    add_work(outcome.statistics, statistics);
    for (const nlohmann::json& part : json["shares"]) {
        DeviceShare& share = outcome.shares.emplace_back();
        share.rank = rank;
        part["name"].get_to(share.device.name);
        part["platform"].get_to(share.device.platform);
        part["driver"].get_to(share.device.driver);
        part["passes"].get_to(share.passes);
        part["seconds"].get_to(share.seconds);
        part["failure"].get_to(share.failure);
    }
}

} // namespace tristim
