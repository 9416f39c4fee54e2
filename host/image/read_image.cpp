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

namespace tristim {
namespace {

using ChannelNumbers = std::array<std::size_t, 3>;

/// Opens the file first, since OpenImageIO does not say why the system would not let it.
void check_readable(const std::string& path) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored))
        fail("cannot read \"{}\": it is a folder", path);
    errno = 0;
    if (!std::ifstream(path, std::ios::binary))
        fail("cannot read \"{}\": {}", path, std::strerror(errno));
}

std::optional<ChannelNumbers> find_channels(const OIIO::ImageSpec& spec, const std::array<const char*, 3>& names) {
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

void check_finite(const std::string& path, const XyzImage& image) {
    std::size_t count = 0;
    std::size_t first = 0;
    for (std::size_t i = 0; i < image.xyz.size(); ++i) {
        const auto& pixel = image.xyz[i];
        if (std::all_of(pixel.begin(), pixel.end(), [](float value) { return std::isfinite(value); }))
            continue;
        if (count++ == 0)
            first = i;
    }
    if (count == 0)
        return;
    const auto width = static_cast<std::size_t>(image.region.width);
    fail("cannot use \"{}\": {} of its {} pixels are infinite or not a number, the first at x = {}, y = {}", path,
         count, image.xyz.size(), image.region.x + static_cast<int>(first % width),
         image.region.y + static_cast<int>(first / width));
}

} // namespace

XyzImage read_exr(const std::string& path) {
    check_readable(path);
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path);
    if (!input) {
        const std::string reason = OIIO::geterror();
        fail("cannot read \"{}\" as an OpenEXR image: {}", path, reason);
    }
    const OIIO::ImageSpec spec = input->spec();
    if (std::strcmp(input->format_name(), "openexr") != 0 || spec.deep)
        fail("cannot read \"{}\": it is not a flat OpenEXR image", path);
    const auto rgb_channels = find_channels(spec, {"R", "G", "B"});
    const auto xyz_channels = find_channels(spec, {"X", "Y", "Z"});
    if (!rgb_channels && !xyz_channels)
        fail("cannot read \"{}\": it has neither channels R, G, B nor X, Y, Z", path);
    if (rgb_channels)
        check_primaries(path, spec);

    const auto channel_count = static_cast<std::size_t>(spec.nchannels);
    std::vector<float> values(spec.image_pixels() * channel_count);
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data()))
        fail("cannot read \"{}\": {}", path, input->geterror());

    XyzImage image{
        spec.full_width, spec.full_height, {spec.x - spec.full_x, spec.y - spec.full_y, spec.width, spec.height}, {}};
    image.xyz.reserve(spec.image_pixels());
    const ChannelNumbers& channels = rgb_channels ? *rgb_channels : *xyz_channels;
    for (std::size_t i = 0; i < values.size(); i += channel_count) {
        const std::array<float, 3> pixel{values[i + channels[0]], values[i + channels[1]], values[i + channels[2]]};
        if (rgb_channels) {
            const Xyz xyz = rgb_to_xyz({pixel[0], pixel[1], pixel[2]});
            image.xyz.push_back({static_cast<float>(xyz[0]), static_cast<float>(xyz[1]), static_cast<float>(xyz[2])});
        } else {
            image.xyz.push_back(pixel);
        }
    }
    check_finite(path, image);
    return image;
}

} // namespace tristim
