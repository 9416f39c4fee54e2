#include "bench/scene_identity.h"

#include <fmt/format.h>

#include <cstdint>
#include <type_traits>
#include <vector>

namespace tristim {
namespace {

/// FNV-1a with 64 bits (Fowler, Noll & Vo; RFC 9923).
class Hash {
  public:
    template <typename T>
    void add(const T& value) {
        // The structs of kernels/shared_types.h have four-byte members alone, so none of these bytes is padding.
        static_assert(std::is_arithmetic_v<T> || alignof(T) == 4);
        static_assert(std::is_trivially_copyable_v<T>);
        const auto* bytes = reinterpret_cast<const unsigned char*>(&value);
        for (std::size_t i = 0; i < sizeof(T); ++i)
            state_ = (state_ ^ bytes[i]) * 0x100000001b3U;
    }

    template <typename T>
    void add(const std::vector<T>& values) {
        add(static_cast<std::uint64_t>(values.size()));
        for (const T& value : values)
            add(value);
    }

    std::string hexadecimal() const { return fmt::format("{:016x}", state_); }

  private:
    std::uint64_t state_ = 0xcbf29ce484222325U;
};

/// What follows from the scene and from the part of the image that is rendered is none of the camera's.
SceneConstants camera_alone(SceneConstants constants) {
    constants.light_count = constants.infinite_light = 0;
    constants.centre_x = constants.centre_y = constants.centre_z = constants.radius = 0.0F;
    constants.region_x = constants.region_y = constants.region_width = constants.region_height = 0;
    constants.image_width = constants.image_height = 0;
    return constants;
}

} // namespace

SceneIdentity scene_identity(const Scene& scene, const RenderOptions& options) {
    const FlatScene flat = flatten_scene(scene, derive_effects(scene), options.width, options.height, options.region);
    Hash content;
    content.add(flat.triangles);
    content.add(flat.attributes);
    content.add(flat.materials);
    content.add(flat.film_layers);
    content.add(flat.textures);
    content.add(flat.texels);
    content.add(flat.lights);
    content.add(flat.spectra.values(parse_method("spectral:400")));
    content.add(flat.spectra.smooth());
    Hash camera;
    camera.add(camera_alone(flat.constants));
    return {content.hexadecimal(), camera.hexadecimal(), options.width,
            options.height,        options.region,       options.max_depth};
}

} // namespace tristim
