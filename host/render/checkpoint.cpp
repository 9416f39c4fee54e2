#include "render/checkpoint.h"

#include "base/error.h"
#include "base/hash.h"
#include "base/parse_number.h"
#include "base/read_file.h"
#include "base/split.h"
#include "image/output_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fmt/ranges.h>
#include <fstream>
#include <memory>
#include <span>

namespace tristim {
namespace {

/// Counts up when files of before no longer mean the same.
constexpr const char* file_version = "2";
constexpr std::string_view prefix = "tristim:";
constexpr std::string_view settings_prefix = "tristim:setting:";
constexpr std::string_view mark = "tristim:checkpoint";
constexpr std::size_t header_bytes = 1U << 16U; ///< among them the mark stands
/// Stands before the checksum, at the file's very end.
constexpr std::string_view trailer = "\ntristim checksum ";
constexpr std::size_t checksum_digits = 16;
constexpr std::size_t end_bytes = trailer.size() + checksum_digits + 1; ///< of both and the last line's end
constexpr std::size_t word = 4;                                         ///< bytes of a value

/// One channel: a four-byte member of each of the structs in a row.
struct Plane {
    std::string name;
    bool integer;
    std::byte* first;
    std::size_t stride; ///< bytes
};

template <typename T>
std::byte* bytes_of(std::vector<T>& values) {
    return reinterpret_cast<std::byte*>(values.data());
}

/// The members of FilmPixel, by their names.
void add_planes(std::vector<Plane>& planes, std::vector<FilmPixel>& film) {
    const auto add_plane = [&](const std::string& name, bool integer, std::size_t offset) {
        planes.push_back({name, integer, bytes_of(film) + offset, sizeof(FilmPixel)});
    };
#define FLOATS(member)                                                                                                 \
    for (std::size_t c = 0; c < 3; ++c)                                                                                \
    add_plane(fmt::format(#member ".{}", "XYZ"[c]), false, offsetof(FilmPixel, member) + c * word)
#define FLOAT(member) add_plane(#member, false, offsetof(FilmPixel, member))
#define INTEGER(member) add_plane(#member, true, offsetof(FilmPixel, member))
    FLOATS(sum_high);
    FLOATS(sum_middle);
    FLOATS(sum_low);
    FLOATS(square_high);
    FLOATS(square_low);
    INTEGER(samples);
    INTEGER(rejected);
    FLOAT(statistics_radius);
    FLOAT(statistics_radius_low);
    FLOAT(statistics_count);
    FLOAT(statistics_count_low);
    INTEGER(camera_rays);
    INTEGER(shadow_rays);
    INTEGER(ray_carries);
#undef FLOATS
#undef FLOAT
#undef INTEGER
    static_assert(sizeof(FilmPixel) == 24 * word, "a new member of FilmPixel needs a plane");
}

std::string error_plane_name(std::size_t plane) {
    return fmt::format("error{}", plane);
}

/// All channels of a checkpoint, whose vectors must have their sizes.
std::vector<Plane> planes_of(Checkpoint& checkpoint) {
    std::vector<Plane> planes;
    add_planes(planes, checkpoint.sums.film);
    planes.push_back({"initial_radius", false, bytes_of(checkpoint.initial_radii), word});
    const std::size_t pixels = checkpoint.sums.film.size();
    for (std::size_t p = 0; p * pixels < checkpoint.sums.error.size(); ++p)
        planes.push_back({error_plane_name(p), false, bytes_of(checkpoint.sums.error) + p * pixels * word, word});
    return planes;
}

/// Texts that the header holds, by name without "tristim:".
using Texts = std::vector<std::pair<std::string, std::string>>;

Texts texts_of(const Checkpoint& c) {
    const RenderSums& sums = c.sums;
    const auto number = [](const auto& value) { return fmt::format("{}", value); };
    return {{"checkpoint", file_version},
            {"passes", sums.passes.text()},
            {"camera_rays", number(sums.rays.camera)},
            {"shadow_rays", number(sums.rays.shadow)},
            {"photon_rays", number(sums.rays.photon)},
            {"non_finite_eye", number(sums.non_finite.eye)},
            {"non_finite_photon", number(sums.non_finite.photon)},
            {"non_finite_gather", number(sums.non_finite.gather)},
            {"non_finite_film", number(sums.non_finite.film)},
            {"photons_stored", number(sums.photons_stored)},
            {"seconds_rendering", number(c.seconds)},
            {"scene", c.scene},
            {"device", c.devices}};
}

OIIO::ImageSpec spec_of(const Checkpoint& c, const std::vector<Plane>& planes) {
    OIIO::ImageSpec spec(c.region.width, c.region.height, static_cast<int>(planes.size()), OIIO::TypeDesc::FLOAT);
    spec.x = c.region.x;
    spec.y = c.region.y;
    spec.full_width = c.width;
    spec.full_height = c.height;
    spec.attribute("compression", "zip");
    spec.channelnames.clear();
    for (const Plane& plane : planes) {
        spec.channelnames.push_back(plane.name);
        spec.channelformats.push_back(plane.integer ? OIIO::TypeDesc::UINT : OIIO::TypeDesc::FLOAT);
    }
    for (const auto& [name, text] : texts_of(c))
        spec.attribute(std::string(prefix) + name, text);
    std::vector<std::string> names;
    for (const auto& [name, value] : c.identity) {
        spec.attribute(std::string(settings_prefix) + name, value);
        names.push_back(name);
    }
    spec.attribute(std::string(prefix) + "settings", fmt::format("{}", fmt::join(names, ","))); // their order
    return spec;
}

std::vector<unsigned char> encode(const OIIO::ImageSpec& spec, const std::vector<std::byte>& pixels) {
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("exr");
    if (!output)
        fail("cannot encode OpenEXR images: {}", OIIO::geterror());
    if (!output->set_ioproxy(&memory) || !output->open("memory.exr", spec) ||
        !output->write_image(OIIO::TypeDesc::UNKNOWN, pixels.data()) || !output->close())
        fail("cannot encode the checkpoint: {}", output->geterror());
    return bytes;
}

std::string checksum(std::string_view bytes) {
    Hash hash;
    hash.add(bytes);
    return hash.hexadecimal();
}

std::string_view text_of(const std::vector<unsigned char>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

[[noreturn]] void fail_damaged(const std::string& path) {
    fail("cannot use the checkpoint \"{}\": it is damaged (cut short, or changed since it was written)", path);
}

bool has_mark(std::string_view bytes) {
    return bytes.substr(0, header_bytes).find(mark) != std::string_view::npos;
}

struct CheckedBytes {
    std::string bytes; ///< without the checksum
    std::string checksum;
};

/// What the file holds, and its checksum is that of.
CheckedBytes checked_bytes(const std::string& path) {
    std::string bytes = read_whole_file(path);
    if (!has_mark(bytes))
        fail("cannot use \"{}\" as a checkpoint: it was not written by tristim's --checkpoint", path);
    const std::size_t end = bytes.size() - std::min(bytes.size(), end_bytes);
    const std::string_view rest = std::string_view(bytes).substr(end);
    const std::string sum = checksum(std::string_view(bytes).substr(0, end));
    if (!rest.starts_with(trailer) || rest.substr(trailer.size()) != sum + "\n")
        fail_damaged(path);
    bytes.resize(end);
    return {std::move(bytes), sum};
}

/// The texts of a header. OpenImageIO leaves out those that are empty.
class Header {
  public:
    Header(const std::string& path, const OIIO::ImageSpec& spec) : path_(path), spec_(spec) {}

    std::string text(const std::string& name, std::string_view before = prefix) const {
        const OIIO::ParamValue* found = spec_.find_attribute(std::string(before) + name, OIIO::TypeDesc::STRING);
        return found == nullptr ? "" : found->get_string(0);
    }

    template <typename Number>
    Number number(const std::string& name) const {
        const auto value = parse_number<Number>(text(name));
        if (!value)
            fail_damaged(path_);
        return *value;
    }

  private:
    const std::string& path_;
    const OIIO::ImageSpec& spec_;
};

void read_header(Checkpoint& c, const Header& header) {
    RenderSums& sums = c.sums;
    if (const std::string passes = header.text("passes"); !passes.empty())
        sums.passes = PassRanges::parse(passes);
    sums.rays.camera = header.number<std::uint64_t>("camera_rays");
    sums.rays.shadow = header.number<std::uint64_t>("shadow_rays");
    sums.rays.photon = header.number<std::uint64_t>("photon_rays");
    sums.non_finite.eye = header.number<std::uint64_t>("non_finite_eye");
    sums.non_finite.photon = header.number<std::uint64_t>("non_finite_photon");
    sums.non_finite.gather = header.number<std::uint64_t>("non_finite_gather");
    sums.non_finite.film = header.number<std::uint64_t>("non_finite_film");
    sums.photons_stored = header.number<std::uint64_t>("photons_stored");
    c.seconds = header.number<double>("seconds_rendering");
    c.scene = header.text("scene");
    c.devices = header.text("device");
    for (const std::string& name : split(header.text("settings"), ','))
        c.identity.emplace_back(name, header.text(name, settings_prefix));
}

void copy_words(std::byte* to, std::size_t to_stride, const std::byte* from, std::size_t from_stride,
                std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        std::memcpy(to + i * to_stride, from + i * from_stride, word);
}

} // namespace

std::string write_checkpoint(const std::string& path, const Checkpoint& checkpoint) {
    // Planes are for reading as well; here they are only read from.
    const std::vector<Plane> planes = planes_of(const_cast<Checkpoint&>(checkpoint));
    const std::size_t pixels = checkpoint.sums.film.size(), stride = planes.size() * word;
    std::vector<std::byte> values(pixels * stride);
    for (std::size_t p = 0; p < planes.size(); ++p)
        copy_words(values.data() + p * word, stride, planes[p].first, planes[p].stride, pixels);
    std::vector<unsigned char> bytes = encode(spec_of(checkpoint, planes), values);
    const std::string sum = checksum(text_of(bytes)), end = fmt::format("{}{}\n", trailer, sum);
    bytes.insert(bytes.end(), end.begin(), end.end());
    replace_file(path, bytes);
    return sum;
}

Checkpoint read_checkpoint(const std::string& path) {
    const auto [bytes, sum] = checked_bytes(path);
    OIIO::Filesystem::IOMemReader memory(const_cast<char*>(bytes.data()), bytes.size());
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open("memory.exr", nullptr, &memory);
    if (!input)
        fail_damaged(path);
    const OIIO::ImageSpec spec = input->spec();
    const Header header(path, spec);
    if (header.text("checkpoint") != file_version)
        fail("cannot use the checkpoint \"{}\": it was written by another version of tristim", path);

    Checkpoint c;
    c.checksum = sum;
    c.width = spec.full_width;
    c.height = spec.full_height;
    c.region = {spec.x, spec.y, spec.width, spec.height};
    read_header(c, header);
    const auto pixels = static_cast<std::size_t>(c.region.pixels());
    c.sums.film.resize(pixels);
    c.initial_radii.resize(pixels);
    if (spec.channelindex(error_plane_name(0)) >= 0)
        c.sums.error.resize(ERROR_PLANES * pixels);
    const std::size_t stride = spec.channelnames.size() * word;
    std::vector<std::byte> values(pixels * stride);
    if (spec.pixel_bytes(true) != stride ||
        !input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UNKNOWN, values.data()))
        fail_damaged(path);
    for (const Plane& plane : planes_of(c)) {
        const int channel = spec.channelindex(plane.name);
        if (channel < 0 ||
            spec.channelformat(channel) != (plane.integer ? OIIO::TypeDesc::UINT : OIIO::TypeDesc::FLOAT))
            fail_damaged(path);
        copy_words(plane.first, plane.stride, values.data() + static_cast<std::size_t>(channel) * word, stride, pixels);
    }
    return c;
}

std::string checksum_in(const std::string& path) {
    std::error_code none;
    const std::uintmax_t bytes = std::filesystem::file_size(path, none);
    std::string end(end_bytes, '\0');
    std::ifstream file(path, std::ios::binary);
    if (none || bytes < end_bytes || !file.seekg(static_cast<std::streamoff>(bytes - end_bytes)) ||
        !file.read(end.data(), static_cast<std::streamsize>(end_bytes)) || !end.starts_with(trailer))
        return {};
    return end.substr(trailer.size(), checksum_digits);
}

bool is_checkpoint(const std::string& path) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored))
        return false;
    std::ifstream file(path, std::ios::binary);
    std::string bytes(header_bytes, '\0');
    file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return has_mark(bytes);
}

void check_new_checkpoint(const std::string& path) {
    check_output_file(path);
    if (std::error_code ignored; std::filesystem::exists(path, ignored))
        fail("\"{}\" is there already: go on from it by render --resume, or give --checkpoint another name", path);
}

void add_checkpoint(Checkpoint& checkpoint, const std::string& name, const Checkpoint& more,
                    const std::string& more_name, bool any_radii) {
    const auto refuse = [&](const std::string& reason) {
        fail("cannot merge \"{}\" with \"{}\": {}", more_name, name, reason);
    };
    if (const std::string difference = describe_difference(more.identity, checkpoint.identity); !difference.empty())
        refuse(difference);
    if (value_of(checkpoint.identity, "radius") == "statistics")
        refuse("with --radius statistics each pass depends on those before it");
    if (const PassRanges both = checkpoint.sums.passes.common(more.sums.passes); !both.empty())
        refuse(fmt::format("both hold the passes {}", both.text()));
    const auto radii = [](const Checkpoint& c) { return std::as_bytes(std::span(c.initial_radii)); };
    if (!any_radii && !std::ranges::equal(radii(checkpoint), radii(more)))
        refuse("they began with other search radii, as devices measured them; give all one --initial-radius, or merge "
               "with --any-radii");
    add(checkpoint.sums, more.sums);
    checkpoint.seconds += more.seconds;
    if (checkpoint.devices.find(more.devices) == std::string::npos)
        checkpoint.devices += ", " + more.devices;
}

} // namespace tristim
