#include "image/write_image.h"

#include "base/error.h"
#include "image/output_file.h"
#include "spectra/colour.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <limits>
#include <memory>

namespace tristim {
namespace {

/// Encodes the pixels in memory, so that the disk sees one file write whose every error is checked.
std::vector<unsigned char> encode(const std::string& format, const OIIO::ImageSpec& spec, OIIO::TypeDesc type,
                                  const void* pixels) {
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(format);
    if (!output)
        fail("cannot encode {} images: {}", format, OIIO::geterror());
    if (!output->set_ioproxy(&memory) || !output->open("memory." + format, spec) ||
        !output->write_image(type, pixels) || !output->close())
        fail("cannot encode the {} image: {}", format, output->geterror());
    return bytes;
}

void set_attribute(OIIO::ImageSpec& spec, const std::string& name, const std::string& value) {
    spec.attribute(name, value);
}

void set_attribute(OIIO::ImageSpec& spec, const std::string& name, double value) {
    spec.attribute(name, OIIO::TypeDesc::DOUBLE, &value);
}

void set_attribute(OIIO::ImageSpec& spec, const std::string& name, std::int64_t value) {
    using Int = std::numeric_limits<int>;
    if (value < Int::min() || value > Int::max())
        spec.attribute(name, std::to_string(value));
    else
        spec.attribute(name, static_cast<int>(value));
}

std::vector<std::array<float, 3>> linear_rgb(const XyzImage& image) {
    std::vector<std::array<float, 3>> pixels;
    pixels.reserve(image.xyz.size());
    for (const auto& [x, y, z] : image.xyz) {
        const Rgb rgb = xyz_to_rgb({x, y, z});
        pixels.push_back({static_cast<float>(rgb[0]), static_cast<float>(rgb[1]), static_cast<float>(rgb[2])});
    }
    return pixels;
}

} // namespace

void check_writable(const std::string& path) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension != ".exr" && extension != ".png")
        fail("cannot write \"{}\": the extension \"{}\" is neither .exr nor .png", path, extension);
    check_output_file(path);
}

void write_exr(const std::string& path, const XyzImage& image, ColourSpace space, const ImageMetadata& metadata,
               const ImageLayers& layers, const ImagePlanes& planes) {
    const std::size_t channels = 3 * (1 + layers.size()) + planes.size();
    OIIO::ImageSpec spec(image.region.width, image.region.height, static_cast<int>(channels), OIIO::TypeDesc::FLOAT);
    spec.x = image.region.x;
    spec.y = image.region.y;
    spec.full_width = image.full_width;
    spec.full_height = image.full_height;
    spec.attribute("compression", "zip");
    if (space == ColourSpace::Srgb) {
        spec.attribute("oiio:ColorSpace", "Linear");
        spec.channelnames = {"R", "G", "B"};
    } else {
        spec.channelnames = {"X", "Y", "Z"};
    }
    for (const auto& [name, values] : layers)
        spec.channelnames.insert(spec.channelnames.end(), {name + ".X", name + ".Y", name + ".Z"});
    for (const auto& [name, values] : planes)
        spec.channelnames.push_back(name);
    for (const auto& [name, value] : metadata)
        std::visit([&](const auto& v) { set_attribute(spec, "tristim:" + name, v); }, value);
    const auto colours = space == ColourSpace::Srgb ? linear_rgb(image) : image.xyz;
    std::vector<float> pixels;
    pixels.reserve(colours.size() * channels);
    for (std::size_t i = 0; i < colours.size(); ++i) {
        pixels.insert(pixels.end(), colours[i].begin(), colours[i].end());
        for (const auto& [name, values] : layers)
            pixels.insert(pixels.end(), values[i].begin(), values[i].end());
        for (const auto& [name, values] : planes)
            pixels.push_back(values[i]);
    }
    replace_file(path, encode("exr", spec, OIIO::TypeDesc::FLOAT, pixels.data()));
}

void write_png(const std::string& path, const XyzImage& image, const ToneMapping& tone_mapping) {
    write_png(path, image, ToneCurve(image, tone_mapping));
}

void write_png(const std::string& path, const XyzImage& image, const ToneCurve& curve) {
    write_png(path, image.region.width, image.region.height, display_image(image, curve));
}

void write_png(const std::string& path, int width, int height, std::span<const std::array<std::uint8_t, 3>> pixels) {
    OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    replace_file(path, encode("png", spec, OIIO::TypeDesc::UINT8, pixels.data()));
}

} // namespace tristim
