#include "render/image_metadata.h"

namespace tristim {

ImageMetadata image_metadata(const Renderer& renderer, const std::string& scene, std::uint64_t rejected_samples) {
    const RenderOptions& options = renderer.options();
    const RenderStatistics& statistics = renderer.statistics();
    const auto integer = [](auto value) { return static_cast<std::int64_t>(value); };
    return {{"scene", scene},
            {"method", options.method.name()},
            {"sequence", sequence_name(options)},
            {"passes", integer(statistics.passes)},
            {"photons", integer(statistics.photons_emitted)},
            {"seed", integer(options.seed)},
            {"device", renderer.device().info.name},
            {"driver", renderer.device().info.driver},
            {"seconds_rendering", statistics.render_seconds},
            {"seconds_building_kernels", statistics.build_kernels_seconds},
            {"non_finite_samples", integer(rejected_samples)},
            {"version", std::string(TRISTIM_VERSION)}};
}

} // namespace tristim
