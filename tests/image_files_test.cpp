#include "image/output_file.h"
#include "image/read_image.h"
#include "image/write_image.h"
#include "scene_folder.h"
#include "spectra/colour.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <sys/resource.h>
#include <sys/stat.h>
#include <vector>

namespace tristim {
namespace {

using test::error_of;
using test::SceneFolder;

/// Values over many magnitudes, some of them negative, as out-of-gamut and noisy pixels have them.
XyzImage random_image(int full_width, int full_height, const Region& region) {
    XyzImage image{full_width, full_height, region, {}};
    std::mt19937 engine(5);
    std::uniform_real_distribution<float> exponent(-20.0f, 12.0f);
    for (int i = 0; i < region.pixels(); ++i) {
        std::array<float, 3> pixel{};
        for (float& value : pixel)
            value = (engine() % 8 == 0 ? -1.0f : 1.0f) * std::exp2(exponent(engine));
        image.xyz.push_back(pixel);
    }
    return image;
}

XyzImage whole_image(int width, int height) {
    return random_image(width, height, {0, 0, width, height});
}

XyzImage one_pixel(const Xyz& xyz) {
    return {1, 1, {0, 0, 1, 1}, {{static_cast<float>(xyz[0]), static_cast<float>(xyz[1]), static_cast<float>(xyz[2])}}};
}

OIIO::ImageSpec spec_of(const std::string& path) {
    const auto input = OIIO::ImageInput::open(path);
    EXPECT_TRUE(input) << OIIO::geterror();
    return input ? input->spec() : OIIO::ImageSpec();
}

std::vector<float> channels_of(const std::string& path) {
    const auto input = OIIO::ImageInput::open(path);
    std::vector<float> values(input->spec().image_pixels() * static_cast<std::size_t>(input->spec().nchannels));
    EXPECT_TRUE(input->read_image(0, 0, 0, -1, OIIO::TypeDesc::FLOAT, values.data()));
    return values;
}

/// Writes an EXR as another program might.
void write_foreign_exr(const std::string& path, const OIIO::ImageSpec& spec, const std::vector<float>& values) {
    const auto output = OIIO::ImageOutput::create("exr");
    ASSERT_TRUE(output->open(path, spec) && output->write_image(OIIO::TypeDesc::FLOAT, values.data()) &&
                output->close())
        << output->geterror();
}

OIIO::ImageSpec foreign_spec(int width, int height, const std::vector<std::string>& channels) {
    OIIO::ImageSpec spec(width, height, static_cast<int>(channels.size()), OIIO::TypeDesc::FLOAT);
    spec.channelnames = channels;
    return spec;
}

std::string bytes_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> names_in(const std::string& folder) {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        names.push_back(entry.path().filename().string());
    return names;
}

/// While it lives, files cannot grow beyond a size: writing fails as it does on a full disk, with EFBIG for ENOSPC.
class FullDisk {
  public:
    explicit FullDisk(::rlim_t bytes) : old_handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        ::getrlimit(RLIMIT_FSIZE, &old_limit_);
        const ::rlimit limit{bytes, old_limit_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FullDisk() {
        ::setrlimit(RLIMIT_FSIZE, &old_limit_);
        std::signal(SIGXFSZ, old_handler_);
    }
    FullDisk(const FullDisk&) = delete;
    FullDisk& operator=(const FullDisk&) = delete;

  private:
    void (*old_handler_)(int);
    ::rlimit old_limit_{};
};

TEST(ImageFiles, XyzRoundTripIsExact) {
    const SceneFolder folder;
    const XyzImage image = whole_image(37, 19);
    write_exr(folder.path("a.exr"), image, ColourSpace::CieXyz, {});
    const XyzImage read = read_exr(folder.path("a.exr"));
    EXPECT_EQ(read.full_width, 37);
    EXPECT_EQ(read.full_height, 19);
    EXPECT_EQ(read.region, image.region);
    EXPECT_EQ(read.xyz, image.xyz);
}

TEST(ImageFiles, SrgbRoundTripLosesOnlyFloatRounding) {
    const SceneFolder folder;
    const XyzImage image = whole_image(37, 19);
    write_exr(folder.path("a.exr"), image, ColourSpace::Srgb, {});
    const XyzImage read = read_exr(folder.path("a.exr"));
    ASSERT_EQ(read.xyz.size(), image.xyz.size());
    bool has_negative_channel = false;
    for (std::size_t i = 0; i < image.xyz.size(); ++i) {
        const auto& [x, y, z] = image.xyz[i];
        const Rgb rgb = xyz_to_rgb({x, y, z});
        has_negative_channel |= *std::min_element(rgb.begin(), rgb.end()) < 0.0;
        for (std::size_t c = 0; c < 3; ++c) {
            // Half a unit in the last place for each channel of the file and for the result; the matrices are doubles.
            double bound = 0x1p-24 * std::abs(image.xyz[i][c]) + 1e-12 * (std::abs(x) + std::abs(y) + std::abs(z));
            for (std::size_t k = 0; k < 3; ++k)
                bound += 0x1p-24 * std::abs(rgb_to_xyz_matrix()[c][k] * rgb[k]);
            EXPECT_NEAR(read.xyz[i][c], image.xyz[i][c], bound) << "pixel " << i << " channel " << c;
        }
    }
    EXPECT_TRUE(has_negative_channel);
}

TEST(ImageFiles, SrgbChannelsAreLinearRec709) {
    const SceneFolder folder;
    write_exr(folder.path("white.exr"), one_pixel({0.95046, 1.0, 1.08906}), ColourSpace::Srgb,
              {}); // D65, IEC 61966-2-1
    for (const float value : channels_of(folder.path("white.exr")))
        EXPECT_NEAR(value, 1.0f, 2e-4f); // the standard's white is rounded to four digits

    // A monochromatic green at 520 nm (CIE 1931) lies outside of the gamut: red is negative.
    write_exr(folder.path("green.exr"), one_pixel({0.06327, 0.71, 0.07825}), ColourSpace::Srgb, {});
    const std::vector<float> green = channels_of(folder.path("green.exr"));
    EXPECT_LT(green[0], -0.5f);
    EXPECT_GT(green[1], 1.0f);
}

TEST(ImageFiles, ChannelsAreNamedFloats) {
    const SceneFolder folder;
    write_exr(folder.path("rgb.exr"), whole_image(3, 2), ColourSpace::Srgb, {});
    write_exr(folder.path("xyz.exr"), whole_image(3, 2), ColourSpace::CieXyz, {});
    EXPECT_EQ(spec_of(folder.path("rgb.exr")).channelnames, (std::vector<std::string>{"R", "G", "B"}));
    EXPECT_EQ(spec_of(folder.path("xyz.exr")).channelnames, (std::vector<std::string>{"X", "Y", "Z"}));
    EXPECT_EQ(spec_of(folder.path("rgb.exr")).format, OIIO::TypeDesc::FLOAT);
    EXPECT_EQ(spec_of(folder.path("xyz.exr")).format, OIIO::TypeDesc::FLOAT);
}

TEST(ImageFiles, RegionIsTheDataWindow) {
    const SceneFolder folder;
    const Region region{5, 7, 11, 3};
    const XyzImage image = random_image(40, 30, region);
    write_exr(folder.path("a.exr"), image, ColourSpace::CieXyz, {});

    const OIIO::ImageSpec spec = spec_of(folder.path("a.exr"));
    EXPECT_EQ((std::array{spec.x, spec.y, spec.width, spec.height}), (std::array{5, 7, 11, 3}));
    EXPECT_EQ((std::array{spec.full_x, spec.full_y, spec.full_width, spec.full_height}), (std::array{0, 0, 40, 30}));

    const XyzImage read = read_exr(folder.path("a.exr"));
    EXPECT_EQ(read.region, region);
    EXPECT_EQ(read.full_width, 40);
    EXPECT_EQ(read.full_height, 30);
    EXPECT_EQ(read.xyz, image.xyz);
}

TEST(ImageFiles, MetadataStandsInTheHeader) {
    const SceneFolder folder;
    constexpr std::int64_t many = 5'000'000'000;
    write_exr(folder.path("a.exr"), whole_image(3, 2), ColourSpace::Srgb,
              {{"scene", "meshes/dispersion/scene.pbrt"},
               {"passes", std::int64_t{64}},
               {"seed", std::int64_t{-3}},
               {"photons", many},
               {"seconds_building_kernels", 0.1}});
    const OIIO::ImageSpec spec = spec_of(folder.path("a.exr"));
    EXPECT_EQ(spec.get_string_attribute("tristim:scene"), "meshes/dispersion/scene.pbrt");
    EXPECT_EQ(spec.get_int_attribute("tristim:passes"), 64);
    EXPECT_EQ(spec.get_int_attribute("tristim:seed"), -3);
    EXPECT_EQ(spec.get_string_attribute("tristim:photons"), "5000000000");
    const auto* seconds = spec.find_attribute("tristim:seconds_building_kernels", OIIO::TypeDesc::DOUBLE);
    ASSERT_NE(seconds, nullptr);
    EXPECT_EQ(*static_cast<const double*>(seconds->data()), 0.1);
}

TEST(ImageFiles, PngIsTheRegionToneMapped) {
    const SceneFolder folder;
    const XyzImage image = random_image(40, 30, {5, 7, 11, 3});
    write_png(folder.path("a.png"), image, {});
    const OIIO::ImageSpec spec = spec_of(folder.path("a.png"));
    EXPECT_EQ((std::array{spec.width, spec.height, spec.nchannels}), (std::array{11, 3, 3}));
    EXPECT_EQ(spec.format, OIIO::TypeDesc::UINT8);

    std::vector<std::array<std::uint8_t, 3>> pixels(spec.image_pixels());
    const auto input = OIIO::ImageInput::open(folder.path("a.png"));
    ASSERT_TRUE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, pixels.data()));
    EXPECT_EQ(pixels, display_image(image, {}));
}

TEST(ImageFiles, ReadsHalfFloatAmongOtherChannels) {
    const SceneFolder folder;
    OIIO::ImageSpec spec = foreign_spec(2, 1, {"R", "G", "B", "A", "depth"});
    spec.set_format(OIIO::TypeDesc::HALF);
    write_foreign_exr(folder.path("a.exr"), spec, {0.5f, 0.25f, 2.0f, 1.0f, 9.0f, -0.5f, 0.0f, 1.0f, 1.0f, 8.0f});
    const XyzImage image = read_exr(folder.path("a.exr"));
    ASSERT_EQ(image.xyz.size(), 2u);
    const std::array<Rgb, 2> expected{{{0.5, 0.25, 2.0}, {-0.5, 0.0, 1.0}}}; // all of them exact in half precision
    for (std::size_t i = 0; i < 2; ++i) {
        const Xyz xyz = rgb_to_xyz(expected[i]);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_FLOAT_EQ(image.xyz[i][c], static_cast<float>(xyz[c]));
    }
}

TEST(ImageFiles, RegionCountsFromTheDisplayWindow) {
    const SceneFolder folder;
    OIIO::ImageSpec spec = foreign_spec(2, 1, {"X", "Y", "Z"});
    spec.x = 13;
    spec.y = 24;
    spec.full_x = 10;
    spec.full_y = 20;
    spec.full_width = 8;
    spec.full_height = 6;
    write_foreign_exr(folder.path("a.exr"), spec, std::vector<float>(6, 1.0f));
    const XyzImage image = read_exr(folder.path("a.exr"));
    EXPECT_EQ(image.region, (Region{3, 4, 2, 1}));
    EXPECT_EQ(image.full_width, 8);
    EXPECT_EQ(image.full_height, 6);
}

TEST(ImageFiles, ReadingTellsWhatIsWrong) {
    const SceneFolder folder;
    const std::string path = folder.path("a.exr");
    const auto expect_error = [&](const std::string& part) {
        const std::string message = error_of([&] { read_exr(path); });
        EXPECT_NE(message.find(part), std::string::npos) << message;
        EXPECT_NE(message.find(path), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    };
    expect_error("No such file");

    folder.write("a.exr", "not an image");
    expect_error("not an OpenEXR file");

    write_foreign_exr(path, foreign_spec(2, 1, {"Y", "RY", "BY"}), std::vector<float>(6, 1.0f));
    expect_error("neither channels R, G, B nor X, Y, Z");

    OIIO::ImageSpec aces = foreign_spec(2, 1, {"R", "G", "B"});
    const std::array<float, 8> primaries{0.7347f, 0.2653f, 0.0f, 1.0f, 0.0001f, -0.077f, 0.32168f, 0.33767f};
    aces.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), primaries.data());
    write_foreign_exr(path, aces, std::vector<float>(6, 1.0f));
    expect_error("Rec.709");

    write_exr(path, whole_image(64, 64), ColourSpace::Srgb, {});
    std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
    expect_error("cannot read");

    std::filesystem::remove(path);
    std::filesystem::create_directory(path);
    expect_error("it is a folder");
}

TEST(ImageFiles, ReadsOnlyOpenExr) {
    const SceneFolder folder;
    write_png(folder.path("a.png"), whole_image(3, 2), {});
    EXPECT_NE(error_of([&] { read_exr(folder.path("a.png")); }).find("not a flat OpenEXR"), std::string::npos);
}

TEST(ImageFiles, NonFinitePixelsAreCountedAndLocated) {
    const SceneFolder folder;
    for (const ColourSpace space : {ColourSpace::Srgb, ColourSpace::CieXyz}) {
        XyzImage image = random_image(40, 30, {5, 7, 11, 3});
        image.xyz[11 + 4][1] = std::numeric_limits<float>::quiet_NaN();
        image.xyz[22 + 9][2] = std::numeric_limits<float>::infinity();
        write_exr(folder.path("a.exr"), image, space, {});
        const std::string message = error_of([&] { read_exr(folder.path("a.exr")); });
        EXPECT_NE(message.find("2 of its 33 pixels"), std::string::npos) << message;
        EXPECT_NE(message.find("x = 9, y = 8"), std::string::npos) << message;
    }
}

TEST(ImageFiles, FullDiskLeavesTheOldFile) {
    const SceneFolder folder;
    const std::string path = folder.write("a.exr", "the old file");
    const XyzImage image = whole_image(64, 64);
    const std::string message = error_of([&] {
        const FullDisk full_disk(1000);
        write_exr(path, image, ColourSpace::Srgb, {});
    });
    EXPECT_NE(message.find(path), std::string::npos) << message;
    EXPECT_NE(message.find("File too large"), std::string::npos) << message;
    EXPECT_EQ(bytes_of(path), "the old file");
    EXPECT_EQ(names_in(folder.path(".")), std::vector<std::string>{"a.exr"});

    write_exr(path, image, ColourSpace::Srgb, {});
    EXPECT_EQ(read_exr(path).xyz.size(), image.xyz.size());
    EXPECT_EQ(names_in(folder.path(".")), std::vector<std::string>{"a.exr"});
}

TEST(ImageFiles, FullDiskLeavesNoNewFile) {
    const SceneFolder folder;
    EXPECT_NE(error_of([&] {
                  const FullDisk full_disk(100);
                  write_png(folder.path("a.png"), whole_image(64, 64), {});
              }).find("File too large"),
              std::string::npos);
    EXPECT_TRUE(names_in(folder.path(".")).empty());
}

TEST(ImageFiles, ReplacingKeepsLinkAndPermissions) {
    const SceneFolder folder;
    const std::string target = folder.write("target.exr", "old");
    ASSERT_EQ(::chmod(target.c_str(), 0640), 0);
    std::filesystem::create_symlink("target.exr", folder.path("link.exr"));
    write_exr(folder.path("link.exr"), whole_image(3, 2), ColourSpace::Srgb, {});
    EXPECT_TRUE(std::filesystem::is_symlink(folder.path("link.exr")));
    EXPECT_EQ(read_exr(target).xyz.size(), 6u);
    struct stat status {};
    ASSERT_EQ(::stat(target.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0640u);
}

TEST(ImageFiles, WritableIsCheckedBeforehand) {
    const SceneFolder folder;
    const auto expect_error = [](const std::string& path, const std::string& part) {
        const std::string message = error_of([&] { check_writable(path); });
        EXPECT_NE(message.find(part), std::string::npos) << message;
        EXPECT_NE(message.find(path), std::string::npos) << message;
    };
    expect_error(folder.path("a.tif"), "\".tif\" is neither .exr nor .png");
    expect_error(folder.path("a"), "neither .exr nor .png");
    expect_error(folder.path("missing/a.exr"), "does not exist");
    folder.write("file", "");
    expect_error(folder.path("file/a.exr"), "is not a folder");
    std::filesystem::create_directory(folder.path("folder.exr"));
    expect_error(folder.path("folder.exr"), "it is a folder");
    ASSERT_EQ(::mkfifo(folder.path("pipe.png").c_str(), 0600), 0);
    expect_error(folder.path("pipe.png"), "not a regular file");

    folder.write("old.PNG", "old");
    EXPECT_NO_THROW(check_writable(folder.path("old.PNG")));
    EXPECT_EQ(bytes_of(folder.path("old.PNG")), "old");
    EXPECT_NO_THROW(check_writable(folder.path("new.exr")));
    EXPECT_FALSE(std::filesystem::exists(folder.path("new.exr")));
    EXPECT_NO_THROW(check_writable("no-folder-in-the-path.exr"));
    // What only an attempt shows: there is no room for the temporary file's longer name, or /proc takes no files.
    expect_error(folder.path(std::string(250, 'a') + ".exr"), "File name too long");
    expect_error("/proc/a.exr", "cannot write \"/proc/a.exr\": ");
    EXPECT_EQ(names_in(folder.path(".")), (std::vector<std::string>{"file", "folder.exr", "old.PNG", "pipe.png"}));
}

TEST(ImageFiles, ALinkToAFileThatIsNotThereYetStays) {
    const SceneFolder folder;
    std::filesystem::create_directory(folder.path("elsewhere"));
    std::filesystem::create_symlink("elsewhere/b.exr", folder.path("a.exr"));
    std::filesystem::create_symlink(folder.path("a.exr"), folder.path("link.exr"));
    EXPECT_TRUE(is_same_file(folder.path("link.exr"), folder.path("./elsewhere/../elsewhere/b.exr")));
    EXPECT_FALSE(is_same_file(folder.path("link.exr"), folder.path("b.exr")));
    EXPECT_FALSE(is_same_file(folder.path("b.exr"), ""));
    replace_file(folder.path("link.exr"), "bytes");
    EXPECT_EQ(bytes_of(folder.path("elsewhere/b.exr")), "bytes");
    EXPECT_TRUE(std::filesystem::is_symlink(folder.path("a.exr")));
    std::filesystem::create_symlink("loop.exr", folder.path("loop.exr"));
    EXPECT_NE(error_of([&] { replace_file(folder.path("loop.exr"), "bytes"); }).find("symbolic links"),
              std::string::npos);
}

TEST(ImageFiles, WritingToAMissingFolderFails) {
    const SceneFolder folder;
    EXPECT_NE(error_of([&] {
                  write_exr(folder.path("missing/a.exr"), whole_image(3, 2), ColourSpace::Srgb, {});
              }).find("does not exist"),
              std::string::npos);
}

} // namespace
} // namespace tristim
