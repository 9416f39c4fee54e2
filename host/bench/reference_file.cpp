#include "bench/reference_file.h"

#include "base/error.h"
#include "bench/variants.h"
#include "image/read_image.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/ranges.h>
#include <limits>
#include <optional>

namespace tristim {
namespace {

using Pixels = std::vector<std::array<float, 3>>;

/// Counts up when files of before no longer mean the same.
constexpr std::int64_t file_version = 1;

std::string half_name(std::size_t half) {
    return fmt::format("half{}", half + 1);
}

std::string snapshot_name(std::size_t half) {
    return fmt::format("snapshot{}", half + 1);
}

void set(ImageMetadata& metadata, const std::string& name, const ImageMetadata::value_type::second_type& value) {
    const auto same = [&name](const auto& entry) { return entry.first == name; };
    const auto found = std::find_if(metadata.begin(), metadata.end(), same);
    if (found != metadata.end())
        found->second = value;
    else
        metadata.emplace_back(name, value);
}

/// The header and the layers of a reference's file; throws Error for what is not there.
class Fields {
  public:
    Fields(const std::string& path, const LayeredImage& file) : path_(path), file_(file) {}

    [[noreturn]] void fail_damaged(const std::string& name) const {
        fail("cannot use \"{}\" as a reference: its \"{}\" is missing or damaged", path_, name);
    }

    template <typename T>
    std::optional<T> find(const std::string& name) const {
        for (const auto& [key, value] : file_.metadata) {
            if (key == name && std::holds_alternative<T>(value))
                return std::get<T>(value);
        }
        return std::nullopt;
    }

    template <typename T>
    T get(const std::string& name) const {
        const std::optional<T> found = find<T>(name);
        if (!found)
            fail_damaged(name);
        return *found;
    }

    /// write_exr turns an integer beyond 32 bits into its digits.
    std::uint64_t count(const std::string& name, std::uint64_t least, std::uint64_t most) const {
        std::uint64_t value = 0;
        if (const auto digits = find<std::string>(name)) {
            const auto [end, error] = std::from_chars(digits->data(), digits->data() + digits->size(), value);
            if (error != std::errc{} || end != digits->data() + digits->size())
                fail_damaged(name);
        } else {
            const auto integer = get<std::int64_t>(name);
            value = integer < 0 ? std::numeric_limits<std::uint64_t>::max() : static_cast<std::uint64_t>(integer);
        }
        if (value < least || value > most)
            fail_damaged(name);
        return value;
    }

    const Pixels& layer(const std::string& name) const {
        for (const auto& [key, values] : file_.layers) {
            if (key == name)
                return values;
        }
        fail_damaged(name);
    }

  private:
    const std::string& path_;
    const LayeredImage& file_;
};

} // namespace

std::vector<std::pair<std::string, std::string>> reference_settings(const RenderOptions& options) {
    std::vector<std::pair<std::string, std::string>> settings;
    const nlohmann::ordered_json json = options_json(options);
    for (const auto& [name, value] : json.items()) {
        // These stand by themselves, and a reference has the global radius.
        if (name == "method" || name == "max_depth" || name == "radius")
            continue;
        settings.emplace_back(name, value.is_string()         ? value.get<std::string>()
                                    : value.is_number_float() ? fmt::format("{}", value.get<double>())
                                                              : value.dump());
    }
    return settings;
}

void write_reference(const std::string& path, const Reference& reference, ImageMetadata metadata) {
    const auto integer = [](auto value) { return static_cast<std::int64_t>(value); };
    set(metadata, "reference", file_version);
    set(metadata, "scene", reference.scene);
    set(metadata, "method", reference.method);
    set(metadata, "passes", integer(reference.passes));
    set(metadata, "photons", integer(reference.photons));
    set(metadata, "seed", integer(reference.seed));
    set(metadata, "seconds_rendering", reference.seconds);
    set(metadata, "non_finite_samples", integer(reference.rejected_samples));
    for (std::size_t h = 0; h < 2; ++h)
        set(metadata, half_name(h) + "_passes", integer(reference.halves[h].passes));
    set(metadata, "snapshot_passes", integer(reference.snapshot_passes));
    set(metadata, "scene_hash", reference.identity.scene);
    set(metadata, "camera_hash", reference.identity.camera);
    set(metadata, "max_depth", integer(reference.identity.max_depth));
    for (const auto& [name, value] : reference.settings)
        set(metadata, name, value);
    ImageLayers layers{{"variance", reference.variance}};
    for (std::size_t h = 0; h < 2; ++h) {
        layers.emplace_back(half_name(h), reference.halves[h].xyz);
        if (reference.snapshot_passes > 0)
            layers.emplace_back(snapshot_name(h), reference.halves[h].snapshot);
    }
    write_exr(path, reference.image, ColourSpace::CieXyz, metadata, layers);
}

Reference read_reference(const std::string& path) {
    LayeredImage file = read_layered_exr(path);
    const Fields fields(path, file);
    if (!fields.find<std::int64_t>("reference"))
        fail("cannot use \"{}\" as a reference: it was not written by tristim reference", path);
    if (fields.get<std::int64_t>("reference") != file_version)
        fail("cannot use \"{}\" as a reference: it was written by another version of tristim", path);
    constexpr std::uint64_t most = std::numeric_limits<std::int64_t>::max();
    Reference r;
    r.variance = fields.layer("variance");
    r.scene = fields.get<std::string>("scene");
    r.method = fields.get<std::string>("method");
    r.passes = fields.count("passes", 1, most);
    r.photons = fields.count("photons", 1, most);
    r.seed = static_cast<std::uint32_t>(fields.count("seed", 0, std::numeric_limits<std::uint32_t>::max()));
    r.seconds = fields.get<double>("seconds_rendering");
    if (!(r.seconds >= 0.0 && std::isfinite(r.seconds)))
        fields.fail_damaged("seconds_rendering");
    r.rejected_samples = fields.count("non_finite_samples", 0, most);
    for (std::size_t h = 0; h < 2; ++h)
        r.halves[h] = {fields.count(half_name(h) + "_passes", 0, r.passes), fields.layer(half_name(h)), {}};
    const std::uint64_t fewer = std::min(r.halves[0].passes, r.halves[1].passes);
    r.snapshot_passes = fields.count("snapshot_passes", 0, fewer > 0 ? fewer - 1 : 0);
    for (std::size_t h = 0; h < 2 && r.snapshot_passes > 0; ++h)
        r.halves[h].snapshot = fields.layer(snapshot_name(h));
    for (const auto& [name, value] : reference_settings({}))
        r.settings.emplace_back(name, fields.get<std::string>(name));
    r.identity = {fields.get<std::string>("scene_hash"),
                  fields.get<std::string>("camera_hash"),
                  file.image.full_width,
                  file.image.full_height,
                  file.image.region,
                  static_cast<int>(fields.count("max_depth", 1, std::numeric_limits<int>::max()))};
    r.image = std::move(file.image);
    return r;
}

std::string describe_difference(const Reference& reference, const SceneIdentity& wanted) {
    const SceneIdentity& is = reference.identity;
    const auto corners = [](const Region& r) {
        return fmt::format("{},{},{},{}", r.x, r.y, r.x + r.width, r.y + r.height);
    };
    std::vector<std::string> clauses;
    if (is.scene != wanted.scene)
        clauses.push_back(fmt::format("it shows another scene (rendered from \"{}\"; its geometry, materials or lights "
                                      "differ)",
                                      reference.scene));
    const bool resized = is.width != wanted.width || is.height != wanted.height;
    if (resized)
        clauses.push_back(
            fmt::format("its resolution is {}x{}, not {}x{}", is.width, is.height, wanted.width, wanted.height));
    else if (is.region != wanted.region)
        clauses.push_back(fmt::format("its region is {}, not {}", corners(is.region), corners(wanted.region)));
    if (!resized && is.camera != wanted.camera) // the hash holds the size of a pixel
        clauses.push_back("its camera is another one");
    if (is.max_depth != wanted.max_depth)
        clauses.push_back(fmt::format("its maximum depth is {}, not {}", is.max_depth, wanted.max_depth));
    return fmt::format("{}", fmt::join(clauses, "; "));
}

void check_reference(const Reference& reference, const std::string& path, const SceneIdentity& wanted) {
    if (const std::string difference = describe_difference(reference, wanted); !difference.empty())
        fail("cannot use \"{}\" as a reference: {}", path, difference);
    if (reference.halves[0].passes == 0 || reference.halves[1].passes == 0)
        fail("cannot use \"{}\" as a reference: one pass does not tell its error; run tristim reference again to "
             "continue it",
             path);
}

} // namespace tristim
