// `tristim effects` and --effects.
#include "child_process.h"
#include "scene_folder.h"

#include <nlohmann/json.hpp>

#include <set>
#include <sstream>

namespace tristim::test {
namespace {

constexpr const char* scene_text = "Camera \"perspective\"\n"
                                   "Film \"rgb\" \"integer xresolution\" [ 16 ] \"integer yresolution\" [ 8 ]\n"
                                   "WorldBegin\n"
                                   "LightSource \"point\" \"point3 from\" [ 0 1 0 ]\n"
                                   "MakeNamedMaterial \"lens\" \"string type\" \"dielectric\"\n"
                                   "NamedMaterial \"lens\"\n"
                                   "Shape \"sphere\" \"float radius\" 2\n"
                                   "Material \"diffuse\"\n"
                                   "Shape \"bilinearmesh\" \"point3 P\" [ -9 -9 5  9 -9 5  -9 9 5  9 9 5 ]\n";

class EffectsCommand : public testing::Test {
  protected:
    nlohmann::json json_of(const std::vector<std::string>& more) const {
        std::vector<std::string> arguments{"effects", scene, "--json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const ChildResult result = run_tristim(arguments);
        EXPECT_EQ(result.exit_code, 0) << result.standard_error;
        return nlohmann::json::parse(result.standard_output);
    }

    SceneFolder folder;
    std::string scene = folder.write("scene.pbrt", scene_text);
};

TEST_F(EffectsCommand, TellsWhyWithoutADevice) {
    const ChildResult result = run_tristim({"effects", scene}, {{"OCL_ICD_VENDORS", "/no/such/folder"}});
    EXPECT_EQ(result.exit_code, 0) << result.standard_error;
    for (const std::string& words :
         {"material \"lens\" (" + scene + ":5)", "point light (" + scene + ":4)", "mesh with normals (" + scene + ":7)",
          std::string("W = 3 a pass"), std::string("three bins"), std::string("HAS_DIELECTRIC=1"),
          std::string("every path carries all wavelengths")})
        EXPECT_NE(result.standard_output.find(words), std::string::npos) << words << " in\n" << result.standard_output;
}

TEST_F(EffectsCommand, JsonOfTheSceneAndOfMore) {
    const nlohmann::json own = json_of({});
    EXPECT_TRUE(own["effects"]["dielectric"]["on"]);
    EXPECT_FALSE(own["effects"]["film"]["on"]);
    EXPECT_EQ(own["effects"]["dielectric"]["reasons"][0]["where"], scene + ":5");
    EXPECT_EQ(own["photons_hold"], "xyz");
    const nlohmann::json more = json_of({"--effects", "absorbing-film", "--method", "tristimulus:2"});
    EXPECT_TRUE(more["effects"]["film"]["on"]);
    EXPECT_EQ(more["effects"]["film"]["reasons"].size(), 0U);
    EXPECT_EQ(more["photons_hold"], "spectrum");
    EXPECT_EQ(more["wavelengths"], (nlohmann::json{{"w", 6}, {"lanes", 8}, {"blocks", 1}, {"padding", 2}}));
    EXPECT_EQ(more["bytes"]["photon"], own["bytes"]["photon"].get<int>() + 8 * 4);
}

TEST_F(EffectsCommand, RenderBuildsJustWhatIsTold) {
    const std::string dump = folder.path("dump");
    const ChildResult render = run_tristim({"render", scene, "--passes", "1", "--photons", "64", "--quiet", "--outfile",
                                            folder.path("image.exr"), "--dump-kernels", dump});
    ASSERT_EQ(render.exit_code, 0) << render.standard_error;
    const nlohmann::json told = json_of({"--photons", "64"});
    std::set<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(dump)) {
        files.insert(entry.path().filename());
        std::istringstream source(read_text(entry.path()));
        std::string line;
        nlohmann::json macros;
        while (std::getline(source, line) && line.rfind("#line", 0) != 0) {
            std::istringstream words(line);
            std::string define, name, value;
            if (words >> define >> name >> value && define == "#define")
                macros[name] = value;
        }
        EXPECT_EQ(macros, told["macros"]) << entry.path();
    }
    EXPECT_EQ(files, told["kernels"].get<std::set<std::string>>());

    // The same programs again from that folder, and none from a folder without.
    const std::vector<std::string> again{
        "render", scene, "--passes", "1", "--photons", "64", "--quiet", "--outfile", folder.path("again.exr")};
    const auto from = [&](const std::string& kernels) {
        std::vector<std::string> arguments = again;
        arguments.insert(arguments.end(), {"--kernels", kernels});
        return run_tristim(arguments);
    };
    EXPECT_EQ(from(dump).exit_code, 0);
    const ChildResult others = run_tristim({"render", scene, "--passes", "1", "--photons", "64", "--max-depth", "3",
                                            "--quiet", "--outfile", folder.path("again.exr"), "--kernels", dump});
    EXPECT_EQ(others.exit_code, 1);
    EXPECT_NE(others.standard_error.find("'wavelengths.cl' was dumped with other options"), std::string::npos)
        << others.standard_error;
    const ChildResult missing = from(folder.path("nowhere"));
    EXPECT_EQ(missing.exit_code, 1);
    EXPECT_NE(missing.standard_error.find("nowhere/wavelengths.cl"), std::string::npos) << missing.standard_error;
}

TEST_F(EffectsCommand, UnknownNamesAreOneError) {
    for (const char* command : {"effects", "render", "bench-pass"}) {
        const ChildResult result = run_tristim({command, scene, "--effects", "film,fog"});
        EXPECT_EQ(result.exit_code, 1) << command;
        EXPECT_EQ(result.standard_error.rfind("tristim: unknown effect 'fog': expected all, or of these", 0), 0U)
            << result.standard_error;
        EXPECT_EQ(result.standard_output, "");
    }
}

} // namespace
} // namespace tristim::test
