#include "scene/image_texture.h"

#include "base/read_file.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>

namespace tristim {

namespace {

/// From a stored value in [0, 1] to a linear one.
using Decoder = std::function<double(double)>;

/// IEC 61966-2-1.
double srgb_decode(double value) {
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

bool is_png(const std::string& name) {
    constexpr std::string_view extension = ".png";
    return name.size() >= extension.size() &&
           std::equal(extension.begin(), extension.end(), name.end() - static_cast<std::ptrdiff_t>(extension.size()),
                      [](char a, char b) { return a == (b >= 'A' && b <= 'Z' ? b - 'A' + 'a' : b); });
}

Decoder decoder(ParameterList& parameters, const std::string& file) {
    const std::string encoding = parameters.text("encoding", is_png(file) ? "sRGB" : "linear");
    if (encoding == "linear")
        return [](double value) { return value; };
    if (encoding == "sRGB")
        return srgb_decode;
    constexpr std::string_view prefix = "gamma ";
    if (encoding.starts_with(prefix)) {
        double gamma = 0.0;
        const char* end = encoding.data() + encoding.size();
        const auto [stop, error] = std::from_chars(encoding.data() + prefix.size(), end, gamma);
        if (error == std::errc() && stop == end && gamma > 0.0 && std::isfinite(gamma))
            return [gamma](double value) { return std::pow(value, gamma); };
    }
    fail_at(parameters.where("encoding"),
            "unknown encoding \"{}\": it is \"linear\", \"sRGB\" or \"gamma\" and a positive number", encoding);
}

Texture::Wrap wrap_mode(ParameterList& parameters) {
    const std::string wrap = parameters.text("wrap", "repeat");
    if (wrap == "repeat")
        return Texture::Wrap::Repeat;
    if (wrap == "clamp")
        return Texture::Wrap::Clamp;
    if (wrap == "black")
        return Texture::Wrap::Black;
    fail_at(parameters.where("wrap"),
            "the wrap mode \"{}\" is not supported: it may be \"repeat\", \"clamp\" or \"black\"", wrap);
}

/// A gigabyte of floats. The head of a file of a few bytes may promise much more.
constexpr double most_values = 1 << 28;

struct Pixels {
    int width = 0, height = 0;
    std::size_t channels = 0;
    std::vector<std::string> names; ///< of the channels
    bool encoded = false;           ///< stored as integers
    std::vector<float> values;
};

Pixels read_pixels(const std::string& path) {
    read_whole_file(path); // OpenImageIO does not say why the system would not let it
    OIIO::ImageSpec hints;
    hints["oiio:UnassociatedAlpha"] = 1; // colours as they are stored
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path, &hints);
    if (!input)
        fail("cannot read \"{}\" as an image: {}", path, OIIO::geterror());
    const OIIO::ImageSpec& spec = input->spec();
    if (spec.deep || spec.depth > 1 || spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0)
        fail("cannot read \"{}\": it is not a flat image", path);
    const auto values = static_cast<double>(spec.width) * spec.height * spec.nchannels;
    if (values > most_values)
        fail("cannot use \"{}\" as a texture: {} by {} pixels of {} channels are more than {:.0f} values", path,
             spec.width, spec.height, spec.nchannels, most_values);
    Pixels pixels{spec.width,
                  spec.height,
                  static_cast<std::size_t>(spec.nchannels),
                  spec.channelnames,
                  !spec.format.is_floating_point(),
                  std::vector<float>(spec.image_pixels() * static_cast<std::size_t>(spec.nchannels))};
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, pixels.values.data()))
        fail("cannot read \"{}\": {}", path, input->geterror());
    return pixels;
}

/// The channels whose mean is the value that pbrt-v4 takes.
std::vector<std::size_t> value_channels(const std::string& path, const Pixels& pixels,
                                        std::vector<std::string>& remarks) {
    const auto find = [&](const char* name) -> std::optional<std::size_t> {
        const auto it = std::find(pixels.names.begin(), pixels.names.end(), name);
        return it == pixels.names.end() ? std::nullopt
                                        : std::optional(static_cast<std::size_t>(it - pixels.names.begin()));
    };
    const auto r = find("R"), g = find("G"), b = find("B"), a = find("A");
    if (r && g && b) {
        if (a) {
            for (std::size_t i = *a; i < pixels.values.size(); i += pixels.channels) {
                if (pixels.values[i] != 1.0F) {
                    remarks.push_back(fmt::format("the texture is the alpha channel of \"{}\"", path));
                    return {*a};
                }
            }
        }
        return {*r, *g, *b};
    }
    if (pixels.channels == 1)
        return {0};
    if (pixels.channels == 2 && a)
        return {1 - *a};
    fail("cannot use \"{}\" as a texture: it has neither one channel nor R, G and B", path);
}

} // namespace

Texture image_texture(ParameterList& parameters, const PathResolver& resolve, std::vector<std::string>& remarks) {
    const std::string name = parameters.text("filename", "");
    if (name.empty())
        fail_at(parameters.where(), "{} has no \"filename\"", parameters.owner());
    const double scale = parameters.number("scale", 1.0);
    const bool invert = parameters.boolean("invert", false);
    const Decoder decode = decoder(parameters, name);
    const std::string filter = parameters.text("filter", "bilinear");
    if (filter == "point" || filter == "trilinear" || filter == "ewa" || filter == "EWA")
        remarks.push_back(fmt::format("the texture's filter \"{}\" is ignored: it is \"bilinear\"", filter));
    else if (filter != "bilinear")
        fail_at(parameters.where("filter"), "unknown filter \"{}\"", filter);
    parameters.ignore("maxanisotropy");

    Texture texture;
    texture.kind = Texture::Kind::Image;
    texture.wrap = wrap_mode(parameters);
    const SourceLocation where = parameters.where("filename");
    with_location(where, [&] {
        const std::string path = resolve(name, where);
        const Pixels pixels = read_pixels(path);
        const std::vector<std::size_t> channels = value_channels(path, pixels, remarks);
        texture.width = pixels.width;
        texture.height = pixels.height;
        texture.texels.reserve(pixels.values.size() / pixels.channels);
        for (std::size_t i = 0; i < pixels.values.size(); i += pixels.channels) {
            double sum = 0.0;
            for (const std::size_t channel : channels) {
                const double stored = pixels.values[i + channel];
                sum += pixels.encoded ? decode(stored) : stored;
            }
            const double value = scale * sum / static_cast<double>(channels.size());
            // pbrt inverts and clamps after filtering, which differs only between texels above and below 1.
            texture.texels.push_back(static_cast<float>(invert ? std::max(0.0, 1.0 - value) : value));
            if (!std::isfinite(texture.texels.back()))
                fail("cannot use \"{}\" as a texture: its pixel ({}, {}) is {}", path,
                     (texture.texels.size() - 1) % static_cast<std::size_t>(pixels.width),
                     (texture.texels.size() - 1) / static_cast<std::size_t>(pixels.width), value);
        }
    });
    texture.outside = invert ? 1.0 : 0.0;
    return texture;
}

} // namespace tristim
