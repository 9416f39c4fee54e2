#include "image/read_image.h"

#include "base/error.h"
#include "spectra/colour.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <set>
#include <string_view>

namespace tristim {
namespace {

using ChannelNumbers = std::array<std::size_t, 3>;

constexpr std::string_view metadata_prefix = "tristim:";

/// Opens the file first, since OpenImageIO does not say why the system would not let it.
void check_readable(const std::string& path) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored))
        fail("cannot read \"{}\": it is a folder", path);
    errno = 0;
    if (!std::ifstream(path, std::ios::binary))
        fail("cannot read \"{}\": {}", path, std::strerror(errno));
}

std::optional<ChannelNumbers> find_channels(const OIIO::ImageSpec& spec, const std::array<std::string, 3>& names) {
    ChannelNumbers numbers{};
    for (std::size_t c = 0; c < names.size(); ++c) {
        const auto found = std::find(spec.channelnames.begin(), spec.channelnames.end(), names[c]);
        if (found == spec.channelnames.end())
            return std::nullopt;
        numbers[c] = static_cast<std::size_t>(found - spec.channelnames.begin());
    }
    return numbers;
}

/// OpenEXR's default primaries are those of Rec.709, so only a file with an attribute can have others.
void check_primaries(const std::string& path, const OIIO::ImageSpec& spec) {
    constexpr std::array<float, 8> rec709{0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f};
    constexpr float tolerance = 1e-3f; // files round to three or four digits
    std::array<float, 8> primaries{};
    if (!spec.getattribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), primaries.data()))
        return;
    for (std::size_t i = 0; i < primaries.size(); ++i) {
        if (!(std::abs(primaries[i] - rec709[i]) <= tolerance))
            fail("cannot read \"{}\": its chromaticities are not those of Rec.709 / sRGB", path);
    }
}

void check_finite(const std::string& path, const Region& region, const std::vector<std::array<float, 3>>& values) {
    std::size_t count = 0;
    std::size_t first = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto& pixel = values[i];
        if (std::all_of(pixel.begin(), pixel.end(), [](float value) { return std::isfinite(value); }))
            continue;
        if (count++ == 0)
            first = i;
    }
    if (count == 0)
        return;
    const auto width = static_cast<std::size_t>(region.width);
    fail("cannot use \"{}\": {} of its {} pixels are infinite or not a number, the first at x = {}, y = {}", path,
         count, values.size(), region.x + static_cast<int>(first % width), region.y + static_cast<int>(first / width));
}

/// A file's header and the values of its channels, pixel by pixel.
struct RawImage {
    OIIO::ImageSpec spec;
    std::vector<float> values;

    std::vector<std::array<float, 3>> pixels(const ChannelNumbers& channels) const {
        std::vector<std::array<float, 3>> result;
        result.reserve(spec.image_pixels());
        for (std::size_t i = 0; i < values.size(); i += static_cast<std::size_t>(spec.nchannels))
            result.push_back({values[i + channels[0]], values[i + channels[1]], values[i + channels[2]]});
        return result;
    }
};

RawImage read_raw(const std::string& path) {
    check_readable(path);
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path);
    if (!input) {
        const std::string reason = OIIO::geterror();
        fail("cannot read \"{}\" as an OpenEXR image: {}", path, reason);
    }
    RawImage raw{input->spec(), {}};
    const OIIO::ImageSpec& spec = raw.spec;
    if (std::strcmp(input->format_name(), "openexr") != 0 || spec.deep)
        fail("cannot read \"{}\": it is not a flat OpenEXR image", path);
    raw.values.resize(spec.image_pixels() * static_cast<std::size_t>(spec.nchannels));
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, raw.values.data()))
        fail("cannot read \"{}\": {}", path, input->geterror());
    return raw;
}

XyzImage colours(const std::string& path, const RawImage& raw) {
    const OIIO::ImageSpec& spec = raw.spec;
    const auto rgb_channels = find_channels(spec, {"R", "G", "B"});
    const auto xyz_channels = find_channels(spec, {"X", "Y", "Z"});
    if (!rgb_channels && !xyz_channels)
        fail("cannot read \"{}\": it has neither channels R, G, B nor X, Y, Z", path);
    if (rgb_channels)
        check_primaries(path, spec);

    XyzImage image{spec.full_width,
                   spec.full_height,
                   {spec.x - spec.full_x, spec.y - spec.full_y, spec.width, spec.height},
                   raw.pixels(rgb_channels ? *rgb_channels : *xyz_channels)};
    if (rgb_channels) {
        for (std::array<float, 3>& pixel : image.xyz) {
            const Xyz xyz = rgb_to_xyz({pixel[0], pixel[1], pixel[2]});
            pixel = {static_cast<float>(xyz[0]), static_cast<float>(xyz[1]), static_cast<float>(xyz[2])};
        }
    }
    check_finite(path, image.region, image.xyz);
    return image;
}

/// An attribute that write_exr wrote; none for other kinds of values.
std::optional<ImageMetadata::value_type> metadatum(const OIIO::ParamValue& attribute) {
    const std::string name = attribute.name().string();
    const auto key = name.substr(std::min(metadata_prefix.size(), name.size()));
    if (!name.starts_with(metadata_prefix))
        return std::nullopt;
    if (attribute.type() == OIIO::TypeDesc::STRING)
        return {{key, attribute.get_string()}};
    if (attribute.type() == OIIO::TypeDesc::INT)
        return {{key, std::int64_t{attribute.get_int()}}};
    if (attribute.type() == OIIO::TypeDesc::DOUBLE)
        return {{key, attribute.get<double>()}};
    return std::nullopt;
}

} // namespace

XyzImage read_exr(const std::string& path) {
    return colours(path, read_raw(path));
}

LayeredImage read_layered_exr(const std::string& path) {
    const RawImage raw = read_raw(path);
    LayeredImage result{colours(path, raw), {}, {}};
    std::set<std::string> names;
    for (const std::string& channel : raw.spec.channelnames) {
        if (channel.size() > 2 && channel.ends_with(".X"))
            names.insert(channel.substr(0, channel.size() - 2));
    }
    for (const std::string& name : names) {
        const auto channels = find_channels(raw.spec, {name + ".X", name + ".Y", name + ".Z"});
        if (!channels)
            continue;
        result.layers.emplace_back(name, raw.pixels(*channels));
        check_finite(path, result.image.region, result.layers.back().second);
    }
    for (const OIIO::ParamValue& attribute : raw.spec.extra_attribs) {
        if (const auto found = metadatum(attribute))
            result.metadata.push_back(*found);
    }
    return result;
}

} // namespace tristim
