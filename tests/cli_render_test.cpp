// What the command does when all is well: help, images, metadata, statistics, limits and Ctrl-C.
#include "child_process.h"
#include "image/read_image.h"
#include "scene_folder.h"
#include "spectra/colour.h"

#include <OpenImageIO/imageio.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <memory>

namespace tristim::test {
namespace {

constexpr const char* small_scene = "Camera \"perspective\"\n"
                                    "Film \"rgb\" \"integer xresolution\" [ 16 ] \"integer yresolution\" [ 8 ] "
                                    "\"string filename\" \"from-scene.exr\"\n"
                                    "WorldBegin\n"
                                    "LightSource \"point\" \"point3 from\" [ 0 1 0 ] \"spectrum I\" \"stdillum-A\"\n"
                                    "Material \"diffuse\" \"rgb reflectance\" [ 0.7 0.3 0.1 ]\n"
                                    "Shape \"bilinearmesh\" \"point3 P\" [ -20 -20 5  20 -20 5  -20 20 5  20 20 5 ]\n";

class CliRender : public testing::Test {
  protected:
    CliRender() : scene(folder.write("scene.pbrt", small_scene)) {}

    ChildResult render(const std::vector<std::string>& more, const ChildLimits& limits = {}) const {
        std::vector<std::string> arguments{"render", scene, "--photons=1024", "--initial-radius=0.5"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_tristim(arguments, {}, limits);
    }

    SceneFolder folder;
    std::string scene;
};

nlohmann::json read_json(const std::string& path) {
    std::ifstream file(path);
    return nlohmann::json::parse(file);
}

TEST_F(CliRender, HelpOfEveryCommandExitsWithZero) {
    for (const char* command :
         {"render", "merge", "reference", "bench", "report", "devices", "compare", "bench-rays", "bench-pass"}) {
        const ChildResult help = run_tristim({command, "--help"});
        EXPECT_EQ(help.exit_code, 0) << command;
        EXPECT_NE(help.standard_output.find(std::string("tristim ") + command), std::string::npos)
            << help.standard_output;
        EXPECT_EQ(help.standard_error, "");
    }
    const ChildResult all = run_tristim({"--help"});
    EXPECT_EQ(all.exit_code, 0);
    for (const char* command :
         {"render", "reference", "bench", "report", "devices", "compare", "bench-rays", "bench-pass"})
        EXPECT_NE(all.standard_output.find(command), std::string::npos) << command;
    EXPECT_EQ(run_tristim({"--version"}).standard_output, TRISTIM_VERSION "\n");
}

TEST_F(CliRender, HelpNamesEveryOptionAndDefaults) {
    const std::string help = run_tristim({"render", "--help"}).standard_output;
    for (const char* words : {"--outfile",      "--method",  "tristimulus:1",   "--sequence",       "stratified",
                              "--passes",       "64",        "--time",          "--photons",        "65536",
                              "--resolution",   "--region",  "--seed",          "--device",         "--direct",
                              "=sample",        "--radius",  "=global",         "--initial-radius", "auto",
                              "--max-depth",    "16",        "--math",          "=precise",         "--space",
                              "=srgb",          "--tonemap", "=photographic",   "--exposure",       "--stats",
                              "--dump-kernels", "--quiet",   "--radius-factor", "--alpha",          "--rgb-upsampling",
                              "--checkpoint",   "--every",   "--resume",        "--pass-range",     "exit status is 3"})
        EXPECT_NE(help.find(words), std::string::npos) << words << " is not in\n" << help;
}

TEST_F(CliRender, ResolutionMayBeAShareOfTheScenes) {
    const std::string path = folder.path("a.exr");
    ASSERT_EQ(render({"--passes=1", "--resolution=50%", "--outfile", path}).exit_code, 0);
    const XyzImage image = read_exr(path);
    EXPECT_EQ(image.full_width, 8);
    EXPECT_EQ(image.full_height, 4);
}

TEST_F(CliRender, DevicesListsTheOneThatRuns) {
    const ChildResult devices = run_tristim({"devices"});
    EXPECT_EQ(devices.exit_code, 0);
    EXPECT_NE(devices.standard_output.find("* 0 "), std::string::npos) << devices.standard_output;
    EXPECT_NE(devices.standard_output.find("can render"), std::string::npos);
}

TEST_F(CliRender, QuietIsSilentAndLoudShowsProgress) {
    const ChildResult quiet = render({"--passes=2", "--quiet", "--outfile", folder.path("a.exr")});
    EXPECT_EQ(quiet.exit_code, 0);
    EXPECT_EQ(quiet.standard_error + quiet.standard_output, "");
    const ChildResult loud = render({"--passes=2", "--outfile", folder.path("a.exr")});
    EXPECT_EQ(loud.exit_code, 0);
    for (const char* words : {"pass 2/2", "photons", "photons/s", "elapsed", "remaining", "a.exr"})
        EXPECT_NE(loud.standard_error.find(words), std::string::npos) << words << "\n" << loud.standard_error;
}

TEST_F(CliRender, ExrCarriesMetadata) {
    const std::string path = folder.path("a.exr");
    ASSERT_EQ(render({"--passes=3", "--seed=11", "--method=tristimulus:2", "--outfile", path}).exit_code, 0);
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path);
    ASSERT_TRUE(input) << OIIO::geterror();
    const OIIO::ImageSpec& spec = input->spec();
    EXPECT_EQ(spec.format, OIIO::TypeDesc::FLOAT);
    EXPECT_EQ(spec.channelnames, (std::vector<std::string>{"R", "G", "B"}));
    EXPECT_EQ(spec.get_string_attribute("tristim:scene"), scene);
    EXPECT_EQ(spec.get_string_attribute("tristim:method"), "tristimulus:2");
    EXPECT_EQ(spec.get_int_attribute("tristim:passes"), 3);
    EXPECT_EQ(spec.get_int_attribute("tristim:photons"), 3 * 1024);
    EXPECT_EQ(spec.get_int_attribute("tristim:seed"), 11);
    EXPECT_NE(spec.get_string_attribute("tristim:device"), "");
    EXPECT_NE(spec.get_string_attribute("tristim:driver"), "");
    EXPECT_EQ(spec.get_string_attribute("tristim:version"), TRISTIM_VERSION);
    for (const char* seconds : {"tristim:seconds_rendering", "tristim:seconds_building_kernels"}) {
        double value = -1.0;
        EXPECT_TRUE(spec.getattribute(seconds, OIIO::TypeDesc::DOUBLE, &value)) << seconds;
        EXPECT_GT(value, 0.0) << seconds;
        EXPECT_LT(value, 600.0) << seconds;
    }
}

TEST_F(CliRender, SpacesAndFilesHoldOneImage) {
    const std::string srgb = folder.path("srgb.exr");
    const std::string xyz = folder.path("xyz.exr");
    const std::string png = folder.path("image.png");
    ASSERT_EQ(render({"--passes=2", "--outfile", srgb, "--outfile", png}).exit_code, 0);
    ASSERT_EQ(render({"--passes=2", "--space=xyz", "--outfile", xyz}).exit_code, 0);
    const auto a = read_exr(srgb);
    const auto b = read_exr(xyz);
    ASSERT_EQ(a.xyz.size(), b.xyz.size());
    for (std::size_t i = 0; i < a.xyz.size(); ++i) {
        // Through the matrix and back in float: some units in the last place of the largest component.
        const float scale = std::max({b.xyz[i][0], b.xyz[i][1], b.xyz[i][2]});
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(a.xyz[i][c], b.xyz[i][c], 1e-6F * scale) << "pixel " << i << " channel " << c;
    }
    const std::unique_ptr<OIIO::ImageInput> picture = OIIO::ImageInput::open(png);
    ASSERT_TRUE(picture) << OIIO::geterror();
    EXPECT_STREQ(picture->format_name(), "png");
    EXPECT_EQ(picture->spec().width, 16);
    EXPECT_EQ(picture->spec().height, 8);
}

/// The extension's case must not decide the format.
TEST_F(CliRender, ExtensionsInCapitalsAreTheSameFormats) {
    const std::string path = folder.path("IMAGE.EXR");
    ASSERT_EQ(render({"--passes=1", "--outfile", path}).exit_code, 0);
    EXPECT_NO_THROW(read_exr(path));
}

TEST_F(CliRender, RegionKeepsItsPlaceInTheWholeImage) {
    const std::string whole = folder.path("whole.exr");
    const std::string part = folder.path("part.exr");
    ASSERT_EQ(render({"--passes=2", "--space=xyz", "--outfile", whole}).exit_code, 0);
    ASSERT_EQ(render({"--passes=2", "--space=xyz", "--region=5,2,12,7", "--outfile", part}).exit_code, 0);
    const auto image = read_exr(part);
    EXPECT_EQ(image.region, (Region{5, 2, 7, 5}));
    EXPECT_EQ(image.full_width, 16);
    const ChildResult compared = run_tristim({"compare", part, whole, "--region=5,2,12,7", "--json"});
    ASSERT_EQ(compared.exit_code, 0) << compared.standard_error;
    EXPECT_EQ(nlohmann::json::parse(compared.standard_output)["rmse"], 0.0) << compared.standard_output;
}

TEST_F(CliRender, StatsHoldEverything) {
    const std::string path = folder.path("stats.json");
    ASSERT_EQ(
        render({"--passes=4", "--seed=3", "--sequence=random", "--outfile", folder.path("a.exr"), "--stats", path})
            .exit_code,
        0);
    const nlohmann::json stats = read_json(path);
    EXPECT_EQ(stats.at("scene"), scene);
    EXPECT_EQ(stats.at("method"), "tristimulus:1");
    EXPECT_EQ(stats.at("sequence"), "random");
    EXPECT_EQ(stats.at("resolution"), (nlohmann::json{16, 8}));
    EXPECT_EQ(stats.at("seed"), 3);
    EXPECT_EQ(stats.at("passes"), 4);
    EXPECT_EQ(stats.at("photons_per_pass"), 1024);
    EXPECT_EQ(stats.at("non_finite_samples"), 0);
    ASSERT_EQ(stats.at("devices").size(), 1U);
    for (const char* of_device : {"name", "platform", "driver"})
        EXPECT_NE(stats.at("devices")[0].at(of_device), "");
    EXPECT_EQ(stats.at("devices")[0].at("passes"), 4);
    EXPECT_EQ(stats.at("devices")[0].at("failure"), "");
    const nlohmann::json& seconds = stats.at("seconds");
    double steps = 0.0;
    for (const char* step : {"wavelengths", "eye", "photon", "grid", "gather", "film"}) {
        EXPECT_GT(seconds.at("steps").at(step).get<double>(), 0.0) << step;
        steps += seconds.at("steps").at(step).get<double>();
    }
    for (const char* part : {"load", "bvh", "build_kernels", "render"})
        EXPECT_GT(seconds.at(part).get<double>(), 0.0) << part;
    EXPECT_LE(steps, seconds.at("render").get<double>());
    // One camera ray a pixel and pass meets the plane, and one shadow ray follows it; every photon path is one ray to
    // the plane or past it, and one more from the plane if it is reflected.
    EXPECT_EQ(stats.at("rays").at("camera"), 4 * 16 * 8);
    EXPECT_EQ(stats.at("rays").at("shadow"), 4 * 16 * 8);
    EXPECT_GE(stats.at("rays").at("photon").get<int>(), 4 * 1024);
    EXPECT_LE(stats.at("rays").at("photon").get<int>(), 2 * 4 * 1024);
    // Direct light is sampled, and nothing sends a reflected photon back.
    EXPECT_EQ(stats.at("photons_stored"), 0);
    EXPECT_LE(stats.at("bytes_per_photon").get<double>(), 64.0);
    EXPECT_EQ(stats.at("bytes").at("photons").get<int>() % 32, 0);
    EXPECT_GT(stats.at("bytes").size(), 10U);
}

TEST_F(CliRender, TheFirstLimitReachedEnds) {
    const auto passes_of = [&](const std::vector<std::string>& limits) {
        const std::string path = folder.path("stats.json");
        std::vector<std::string> arguments{"--quiet", "--outfile", folder.path("a.exr"), "--stats", path};
        arguments.insert(arguments.end(), limits.begin(), limits.end());
        EXPECT_EQ(render(arguments).exit_code, 0);
        return read_json(path).at("passes").get<long>();
    };
    EXPECT_EQ(passes_of({"--passes=2", "--time=500"}), 2);
    const auto start = std::chrono::steady_clock::now();
    const long passes = passes_of({"--passes=100000000", "--time=0.5"});
    EXPECT_GE(passes, 1);
    EXPECT_LT(passes, 100000000);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(60));
    // With neither: 64.
    EXPECT_EQ(passes_of({}), 64);
}

TEST_F(CliRender, InterruptWritesThePassesDone) {
    const std::string path = folder.path("a.exr");
    const std::string stats = folder.path("stats.json");
    ChildLimits limits;
    limits.interrupt_after = std::chrono::milliseconds(500);
    const ChildResult result = render({"--time=300", "--outfile", path, "--stats", stats}, limits);
    EXPECT_EQ(result.exit_code, 3) << result.standard_error;
    EXPECT_NE(result.standard_error.find("interrupted"), std::string::npos) << result.standard_error;
    const long passes = read_json(stats).at("passes").get<long>();
    EXPECT_GE(passes, 1);
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path);
    ASSERT_TRUE(input) << OIIO::geterror();
    EXPECT_EQ(input->spec().get_int_attribute("tristim:passes"), passes);
    EXPECT_NO_THROW(read_exr(path));
}

TEST_F(CliRender, DumpedKernelsAreWholePrograms) {
    const std::string dump = folder.path("kernels");
    ASSERT_EQ(render({"--passes=1", "--outfile", folder.path("a.exr"), "--dump-kernels", dump}).exit_code, 0);
    for (const char* name :
         {"wavelengths.cl", "eye_pass.cl", "photon_pass.cl", "photon_grid.cl", "gather.cl", "film.cl"}) {
        std::ifstream file(std::filesystem::path(dump) / name);
        const std::string text{std::istreambuf_iterator<char>(file), {}};
        EXPECT_NE(text.find("#define W 3"), std::string::npos) << name;
        EXPECT_EQ(text.find("#include \""), std::string::npos) << name;
    }
}

} // namespace
} // namespace tristim::test
