#include "render/image_metadata.h"

#include <fmt/ranges.h>

namespace tristim {

ImageMetadata image_metadata(const RenderOptions& options, const RenderStatistics& statistics,
                             const std::vector<DeviceInfo>& devices, const std::string& scene,
                             std::uint64_t rejected_samples) {
    const auto integer = [](auto value) { return static_cast<std::int64_t>(value); };
    std::vector<std::string> names, drivers;
    for (const DeviceInfo& device : devices) {
        names.push_back(device.name);
        drivers.push_back(device.driver);
    }
    return {{"scene", scene},
            {"method", options.method.name()},
            {"sequence", sequence_name(options)},
            {"passes", integer(statistics.passes)},
            {"photons", integer(statistics.photons_emitted)},
            {"seed", integer(options.seed)},
            {"device", fmt::format("{}", fmt::join(names, ", "))},
            {"driver", fmt::format("{}", fmt::join(drivers, ", "))},
            {"seconds_rendering", statistics.render_seconds},
            {"seconds_building_kernels", statistics.build_kernels_seconds},
            {"non_finite_samples", integer(rejected_samples)},
            {"version", std::string(TRISTIM_VERSION)}};
}

ImageMetadata with_passes(ImageMetadata metadata, const PassRanges& passes) {
    const bool first_ones = passes.ranges().size() <= 1 && passes.missing(0, 1).empty();
    if (!first_ones)
        metadata.emplace_back("pass_ranges", passes.text());
    return metadata;
}

ImageMetadata image_metadata(const Renderer& renderer, const std::string& scene, std::uint64_t rejected_samples) {
    return image_metadata(renderer.options(), renderer.statistics(), {renderer.device().info}, scene, rejected_samples);
}

} // namespace tristim
