#include "render/kernel_macros.h"

#include "bvh/ray_tracer.h"

#include <algorithm>
#include <bit>

namespace tristim {

int radix_bits(int photons_per_pass) {
    const int bits = std::bit_width(static_cast<unsigned>(photons_per_pass)) + 1;
    return std::clamp((bits + 1) / 2, 4, 11);
}

Macros kernel_macros(const RenderOptions& options, const Effects& effects, const Bvh& bvh, const DeviceTuning& tuning) {
    Macros macros = method_macros(options.method, options.random_sequence);
    for (const Macros& more : {effect_macros(effects), traversal_macros(bvh)})
        macros.insert(macros.end(), more.begin(), more.end());
    const auto flag = [](bool on) { return on ? "1" : "0"; };
    macros.emplace_back("MAX_DEPTH", std::to_string(options.max_depth));
    macros.emplace_back("DIRECT_PHOTONS", flag(options.direct_photons));
    macros.emplace_back("RADIUS_STATISTICS", flag(options.statistics_radius));
    macros.emplace_back("ERROR_ESTIMATE", flag(options.error_estimate));
    macros.emplace_back("PATHS_PER_ITEM", std::to_string(tuning.paths_per_item));
    macros.emplace_back("RADIX_BITS", std::to_string(radix_bits(options.photons_per_pass)));
    macros.emplace_back("RECORD_RAYS", flag(options.record_rays));
    macros.emplace_back("LOOPS_END_EARLY", flag(tuning.ends_loops()));
    return macros;
}

BuildOptions build_options(const RenderOptions& options, bool exact) {
    return {options.fast_math && !exact, options.dump_kernels, options.kernels};
}

std::vector<std::string> kernel_files(const FlatScene& scene) {
    std::vector<std::string> files{"wavelengths.cl"};
    if (scene.film_table_rows > 0)
        files.emplace_back("film_tables.cl");
    for (const char* file : {"eye_pass.cl", "photon_pass.cl", "photon_grid.cl", "gather.cl", "film.cl"})
        files.emplace_back(file);
    return files;
}

ItemBytes item_bytes(const Effects& effects, const WavelengthLayout& layout) {
    const std::size_t spectrum = sizeof(float) * static_cast<std::size_t>(layout.padded());
    ItemBytes bytes;
    bytes.pixel = sizeof(float) + sizeof(VisiblePoint) + sizeof(cl_float4) + sizeof(FilmPixel); // first: initial radius
    bytes.photon = sizeof(Photon) + 2 * sizeof(cl_uint2); // keys, and room to sort them
    if (effects.rough_photons) {
        bytes.pixel += sizeof(VisibleSurface);
        bytes.photon += sizeof(PhotonSurface);
    }
    if (has_coloured_eye(effects))
        bytes.pixel += spectrum;
    if (stores_spectral_flux(effects))
        bytes.photon += spectrum;
    return bytes;
}

} // namespace tristim
