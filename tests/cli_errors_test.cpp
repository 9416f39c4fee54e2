// Bad input to the command: one clear sentence on stderr, a non-zero exit, nothing overwritten.
#include "child_process.h"
#include "scene_folder.h"

#include <algorithm>
#include <iterator>

namespace tristim::test {
namespace {

constexpr const char* small_scene = "Camera \"perspective\"\n"
                                    "Film \"rgb\" \"integer xresolution\" [ 16 ] \"integer yresolution\" [ 8 ]\n"
                                    "WorldBegin\n"
                                    "LightSource \"point\" \"point3 from\" [ 0 1 0 ]\n"
                                    "Material \"diffuse\"\n"
                                    "Shape \"bilinearmesh\" \"point3 P\" [ -9 -9 5  9 -9 5  -9 9 5  9 9 5 ]\n";

/// A folder with a scene and an image that was there before.
class CliErrors : public testing::Test {
  protected:
    CliErrors() : scene(folder.write("scene.pbrt", small_scene)), image(folder.write("old.exr", "what was there")) {}

    std::vector<std::string> render_arguments(const std::vector<std::string>& more) const {
        std::vector<std::string> arguments{"render", scene, "--outfile", image, "--quiet"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return arguments;
    }

    /// Expects a failure that says `words`, in a single line of which the rest is for people.
    void expect_failure(const std::vector<std::string>& arguments, const std::string& words,
                        const std::map<std::string, std::string>& environment = {},
                        const ChildLimits& limits = {}) const {
        const ChildResult result = run_tristim(arguments, environment, limits);
        std::string command;
        for (const std::string& argument : arguments)
            command += argument + " ";
        SCOPED_TRACE(command);
        EXPECT_TRUE(result.exit_code == 1 || result.exit_code == 2) << "exit code " << result.exit_code;
        EXPECT_EQ(result.standard_error.rfind("tristim: ", 0), 0U) << result.standard_error;
        EXPECT_EQ(std::count(result.standard_error.begin(), result.standard_error.end(), '\n'), 1)
            << result.standard_error;
        EXPECT_NE(result.standard_error.find(words), std::string::npos) << result.standard_error;
        EXPECT_EQ(result.standard_output, "");
        const bool untouched = read_text(image) == "what was there";
        EXPECT_TRUE(untouched) << "the image that was there before is gone";
        if (!untouched)
            folder.write("old.exr", "what was there");
        // Nor is a temporary file left behind.
        const auto files = std::filesystem::directory_iterator(std::filesystem::path(image).parent_path());
        for (const auto& file : files) {
            const std::string name = file.path().filename().string();
            EXPECT_TRUE(name == "scene.pbrt" || name == "old.exr" || name == "other.pbrt") << "left behind: " << name;
        }
    }

    void expect_render_failure(const std::vector<std::string>& more, const std::string& words) const {
        expect_failure(render_arguments(more), words);
    }

    SceneFolder folder;
    std::string scene;
    std::string image;
};

TEST_F(CliErrors, UnknownCommandsAndFlags) {
    expect_failure({}, "subcommand");
    expect_failure({"paint"}, "subcommand");
    expect_failure({"render"}, "scene");
    expect_render_failure({"--no-such-flag"}, "--no-such-flag");
    expect_failure({"devices", "--no-such-flag"}, "--no-such-flag");
    expect_failure({"compare", image}, "required");
    expect_failure({"bench-pass"}, "required");
}

TEST_F(CliErrors, BadValuesOfEveryOption) {
    const std::vector<std::array<std::string, 3>> cases{
        {"--method", "tristimulus", "tristimulus:N"},
        {"--method", "tristimulus:0", "tristimulus:N"},
        {"--method", "tristimulus:-1", "tristimulus:N"},
        {"--method", "tristimulus:1x", "tristimulus:N"},
        {"--method", "spectral:31", "spectral:400"},
        {"--method", "xyz", "xyz"},
        {"--method", "hero", "hero:C with C from 1 to 768"},
        {"--method", "hero:769", "hero:C with C from 1 to 768"},
        {"--method", "gauss:99", "gauss:C with C from 4 to 7"},
        {"--method", "rgb:3", "nothing may follow rgb"},
        {"--method", "auto:4", "unknown method 'auto:4'"},
        {"--sequence", "halton", "halton"},
        {"--direct", "none", "none"},
        {"--radius", "fixed", "fixed"},
        {"--math", "sloppy", "sloppy"},
        {"--rgb-upsampling", "smits", "smits"},
        {"--space", "lab", "lab"},
        {"--tonemap", "film", "film"},
        {"--exposure", "bright", "bright"},
        {"--exposure", "nan", "exposure"},
        {"--passes", "0", "passes"},
        {"--passes", "-3", "-3"},
        {"--passes", "1.5", "1.5"},
        {"--time", "0", "time"},
        {"--time", "-1", "time"},
        {"--time", "nan", "time"},
        {"--time", "soon", "soon"},
        {"--alpha", "0", "alpha"},
        {"--alpha", "1", "alpha"},
        {"--alpha", "nan", "alpha"},
        {"--radius-factor", "0", "radius factor"},
        {"--radius-factor", "inf", "radius factor"},
        {"--photons", "0", "photons"},
        {"--photons", "-5", "photons"},
        {"--photons", "99999999999", "99999999999"},
        {"--photons", "many", "many"},
        {"--resolution", "0x0", "0x0"},
        {"--resolution", "640", "640"},
        {"--resolution", "0%", "0%"},
        {"--resolution", "50%x", "50%x"},
        {"--resolution", "-4x4", "-4x4"},
        {"--resolution", "4x4x4", "4x4x4"},
        {"--resolution", "100000x4", "100000x4"},
        {"--region", "0,0,17,8", "16x8"},
        {"--region", "4,4,4,8", "4,4,4,8"},
        {"--region", "-1,0,4,4", "-1,0,4,4"},
        {"--region", "0,0,4", "0,0,4"},
        {"--seed", "-1", "-1"},
        {"--seed", "4294967296", "4294967296"},
        {"--seed", "abc", "abc"},
        {"--max-depth", "0", "depth"},
        {"--max-depth", "-2", "depth"},
        {"--initial-radius", "0", "radius"},
        {"--initial-radius", "-0.1", "radius"},
        {"--initial-radius", "nan", "radius"},
        {"--initial-radius", "wide", "wide"},
        {"--device", "no such device", "no such device"},
        {"--device", "4711", "4711"},
        {"--stats", "/nonexistent/stats.json", "/nonexistent"},
        {"--dump-kernels", "/proc/no-such-folder", "/proc/no-such-folder"},
    };
    // The other limit keeps a value that is wrongly accepted from rendering for long.
    for (const auto& [option, value, words] : cases)
        expect_render_failure({option + "=" + value, option == "--passes" ? "--time=1" : "--passes=1"}, words);
}

TEST_F(CliErrors, OptionsWithoutTheirValue) {
    for (const char* option : {"--method", "--passes", "--time", "--photons", "--resolution", "--outfile", "--stats"})
        expect_render_failure({option}, option);
}

TEST_F(CliErrors, Scenes) {
    expect_failure({"render", folder.path("missing.pbrt"), "--outfile", image}, "missing.pbrt");
    expect_failure({"render", folder.path(""), "--outfile", image}, folder.path(""));
    expect_failure({"bench-pass", folder.path("missing.pbrt")}, "missing.pbrt");
    const auto expect = [this](const std::string& text, const std::string& words) {
        expect_failure({"render", folder.write("other.pbrt", text), "--outfile", image, "--passes", "1"}, words);
    };
    expect("Camera \"perspective\"\nWorldBegin\nTwist 1 2 3\n", "other.pbrt:3");
    expect(with_world("Shape \"trianglemesh\" \"point3 P\" [0 0 5 1 0 5 0 1 5]\n"), "light");
    expect(with_world("LightSource \"point\" \"float scale\" [ 0 ]\n"
                      "Shape \"trianglemesh\" \"point3 P\" [0 0 5 1 0 5 0 1 5]\n"),
           "must emit");
    expect(with_lit_world("Shape \"plymesh\" \"string filename\" \"absent.ply\"\n"), "absent.ply");
}

TEST_F(CliErrors, OutputFiles) {
    expect_failure({"render", scene, "--passes=1", "--outfile", folder.path("no/such/folder/a.exr")}, "does not exist");
    expect_failure({"render", scene, "--passes=1", "--outfile", folder.path("a.jpeg")}, ".jpeg");
    expect_failure({"render", scene, "--passes=1", "--outfile", folder.path("a")}, "a");
    // One bad name among good ones: nothing at all is rendered.
    expect_failure({"render", scene, "--passes=1", "--outfile", image, "--outfile", folder.path("b.tiff")}, ".tiff");
}

/// The largest file of the child is 4 MiB: more than PoCL's own temporary files, less than the image.
TEST_F(CliErrors, FullDisk) {
    ChildLimits limits;
    limits.file_size = 4U << 20U;
    expect_failure(render_arguments({"--resolution=1200x1200", "--photons=64", "--passes=1", "--initial-radius=0.1"}),
                   "cannot write", {}, limits);
}

TEST_F(CliErrors, NoOpenClPlatform) {
    const std::map<std::string, std::string> none{{"OCL_ICD_VENDORS", "/nonexistent/"}};
    expect_failure(render_arguments({"--passes=1"}), "OpenCL", none);
    expect_failure({"devices"}, "OpenCL", none);
    expect_failure({"bench-pass", scene}, "OpenCL", none);
    expect_failure(render_arguments({"--passes=1"}), "no such device", {{"TRISTIM_DEVICE", "no such device"}});
}

TEST_F(CliErrors, DeviceOutOfMemory) {
    expect_failure(render_arguments({"--photons=134217728", "--method=spectral:400", "--passes=1"}),
                   "out of device memory");
    // A device of 1 GiB, of which PoCL gives 256 MiB to a buffer: 2^20 paths of 1.5 photons need more for 400
    // wavelengths.
    folder.write("other.pbrt", std::string(small_scene) + "Material \"dielectric\" \"spectrum eta\" \"glass-BK7\"\n"
                                                          "Shape \"sphere\"\n");
    expect_failure({"render", folder.path("other.pbrt"), "--outfile", image, "--quiet", "--passes=1",
                    "--photons=1048576", "--method=spectral:400"},
                   "photon spectra", {{"POCL_MEMORY_LIMIT", "1"}});
}

TEST_F(CliErrors, CompareRefusesWhatIsNoImage) {
    expect_failure({"compare", image, image}, "old.exr");
    expect_failure({"compare", image, folder.path("missing.exr")}, "exr");
}

} // namespace
} // namespace tristim::test
