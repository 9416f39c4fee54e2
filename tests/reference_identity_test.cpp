// What a reference belongs to: any change of the scene that an image could show changes the hash, nothing else does.
#include "render/scene_identity.h"
#include "scene_folder.h"

#include <array>
#include <string>
#include <vector>

namespace tristim::test::reference_identity_test {
namespace {

constexpr const char* triangle_ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                                     "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                                     "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

constexpr const char* scene_text =
    "LookAt 1 -6 4  0 0 0  0 0 1\n"
    "Camera \"perspective\" \"float fov\" [ 32 ] \"float lensradius\" [ 0.01 ] \"float focaldistance\" [ 5 ]\n"
    "Film \"rgb\" \"integer xresolution\" [ 16 ] \"integer yresolution\" [ 8 ] \"string filename\" \"a.exr\"\n"
    "Integrator \"sppm\" \"integer maxdepth\" [ 9 ] \"integer photonsperiteration\" [ 512 ] \"float radius\" [ 0.1 ]\n"
    "WorldBegin\n"
    "LightSource \"spot\" \"spectrum I\" \"stdillum-D65\" \"float scale\" [ 250 ] \"point3 from\" [ -5 -2 5 ]\n"
    "  \"point3 to\" [ 0 0 0.5 ] \"float coneangle\" [ 11 ] \"float conedeltaangle\" [ 3 ]\n"
    "AttributeBegin\n"
    "  AreaLightSource \"diffuse\" \"rgb L\" [ 1 0.9 0.8 ] \"float scale\" [ 7 ]\n"
    "  Shape \"trianglemesh\" \"point3 P\" [ 0 0 4  1 0 4  0 1 4 ]\n"
    "AttributeEnd\n"
    "Texture \"grey\" \"float\" \"bilerp\" \"float v00\" [ 300 ] \"float v11\" [ 500 ]\n"
    "Material \"diffuse\" \"rgb reflectance\" [ 0.75 0.7 0.3 ]\n"
    "Shape \"bilinearmesh\" \"point3 P\" [ -9 -9 0   9 -9 0   -9 6 0   9 6 0 ]\n"
    "Material \"conductor\" \"spectrum eta\" \"metal-Ag-eta\" \"spectrum k\" \"metal-Ag-k\" \"float roughness\" [ 0.2 "
    "]\n"
    "  \"texture filmthickness\" \"grey\" \"float filmeta\" [ 1.4 ]\n"
    "Shape \"trianglemesh\" \"point3 P\" [ 0 0 1  1 0 1  0 1 1 ]\n"
    "Material \"dielectric\" \"float eta\" [ 1.6 ] \"float filmthickness\" [ 440 ] \"string filmeta\" [ \"SiO2\" ]\n"
    "Translate 0 0 2\n"
    "Shape \"plymesh\" \"string filename\" \"triangle.ply\"\n";

/// The text with one place changed, which must be there.
std::string changed(const std::string& from, const std::string& to) {
    const std::string text = scene_text;
    const std::size_t place = text.find(from);
    EXPECT_NE(place, std::string::npos) << from;
    return text.substr(0, place) + to + text.substr(place + from.size());
}

class Identity : public testing::Test {
  protected:
    Identity() { folder.write("triangle.ply", triangle_ply); }

    SceneIdentity of(const std::string& text, const std::string& file = "scene.pbrt") const {
        const Scene scene = load_scene(folder.write(file, text));
        return scene_identity(scene, options_from_scene(scene.settings));
    }

    SceneFolder folder;
};

TEST_F(Identity, SeesEveryChangeOfTheScene) {
    const SceneIdentity original = of(scene_text);
    const std::vector<std::array<std::string, 2>> changes{
        {"stdillum-D65", "stdillum-A"},
        {"[ 250 ]", "[ 250.001 ]"},
        {"from\" [ -5", "from\" [ -5.00001"},
        {"to\" [ 0", "to\" [ 0.001"},
        {"coneangle\" [ 11", "coneangle\" [ 11.001"},
        {"conedeltaangle\" [ 3", "conedeltaangle\" [ 3.001"},
        {"L\" [ 1", "L\" [ 0.999"},
        {"[ 7 ]", "[ 7.001 ]"},
        {"[ 0 0 4  1", "[ 0 0 4  1.001"},
        {"v11\" [ 500", "v11\" [ 500.1"},
        {"0.75 0.7", "0.75 0.701"},
        {"-9 6 0", "-9 6.001 0"},
        {"metal-Ag-eta", "metal-Cu-eta"},
        {"metal-Ag-k", "metal-Cu-k"},
        {"roughness\" [ 0.2", "roughness\" [ 0.201"},
        {"filmeta\" [ 1.4", "filmeta\" [ 1.401"},
        {"eta\" [ 1.6", "eta\" [ 1.601"},
        {"[ 440 ]", "[ 440.1 ]"},
        {"SiO2", "MgF2"},
        {"Translate 0 0 2", "Translate 0 0 2.0001"},
        {"Material \"dielectric\" \"float eta\" [ 1.6 ] \"float filmthickness\" [ 440 ] \"string filmeta\" [ \"SiO2\" "
         "]",
         "Material \"dielectric\" \"float eta\" [ 1.6 ]"},
        {"AreaLightSource", "ReverseOrientation\nAreaLightSource"},
        {"WorldBegin", "Option \"string rgbupsampling\" \"meng\"\nWorldBegin"},
    };
    for (const auto& [from, to] : changes) {
        const SceneIdentity other = of(changed(from, to));
        EXPECT_NE(other.scene, original.scene) << from << " -> " << to;
        EXPECT_EQ(other.camera, original.camera) << from << " -> " << to;
    }
    std::string moved = triangle_ply;
    moved[moved.find("0 1 0\n")] = '1';
    folder.write("triangle.ply", moved);
    EXPECT_NE(of(scene_text).scene, original.scene) << "the mesh file";
}

TEST_F(Identity, SeesTheCameraApart) {
    const SceneIdentity original = of(scene_text);
    const std::vector<std::array<std::string, 2>> changes{
        {"LookAt 1", "LookAt 1.0001"},
        {"4  0 0 0  0", "4  0 0 0.001  0"},
        {"0 0 1\nCamera", "0 0.01 1\nCamera"},
        {"[ 32 ]", "[ 32.001 ]"},
        {"[ 0.01 ]", "[ 0.0101 ]"},
        {"[ 5 ]", "[ 5.001 ]"},
        {"\"float fov\"", "\"float screenwindow\" [ -2 2 -1 0.9 ] \"float fov\""},
    };
    for (const auto& [from, to] : changes) {
        const SceneIdentity other = of(changed(from, to));
        EXPECT_NE(other.camera, original.camera) << from << " -> " << to;
        EXPECT_EQ(other.scene, original.scene) << from << " -> " << to;
    }
    const SceneIdentity larger = of(changed("xresolution\" [ 16", "xresolution\" [ 17"));
    EXPECT_EQ(larger.width, 17);
    EXPECT_EQ(larger.region, (Region{0, 0, 17, 8}));
    EXPECT_EQ(larger.scene, original.scene);
    const SceneIdentity shallower = of(changed("maxdepth\" [ 9", "maxdepth\" [ 8"));
    EXPECT_EQ(shallower.max_depth, 8);
    EXPECT_EQ(shallower.scene, original.scene);
    EXPECT_EQ(shallower.camera, original.camera);
}

TEST_F(Identity, DoesNotSeeWhatNoImageShows) {
    const SceneIdentity original = of(scene_text);
    EXPECT_EQ(of(scene_text), original) << "the same again";
    EXPECT_EQ(of("# a comment\n" + changed("\n  \"point3 to\"", "   # another\n\n\"point3 to\""), "other.pbrt"),
              original);
    EXPECT_EQ(of(changed("\"a.exr\"", "\"b.exr\"")), original);
    EXPECT_EQ(of(changed("[ 512 ]", "[ 513 ]")), original);
    EXPECT_EQ(of(changed("radius\" [ 0.1 ]", "radius\" [ 0.2 ]")), original);
    folder.write("renamed.ply", triangle_ply);
    EXPECT_EQ(of(changed("triangle.ply", "renamed.ply")), original);

    const Scene scene = folder.load(scene_text);
    RenderOptions options = options_from_scene(scene.settings);
    options.method = parse_method("rgb");
    options.seed = 7;
    options.direct_photons = true;
    options.photon_roughness = 0.5;
    EXPECT_EQ(scene_identity(scene, options), original);
    // The expected image of a part is part of the expected image.
    options.region = {4, 2, 8, 4};
    const SceneIdentity part = scene_identity(scene, options);
    EXPECT_EQ(part.scene, original.scene);
    EXPECT_EQ(part.camera, original.camera);
    EXPECT_EQ(part.region, options.region);
}

} // namespace
} // namespace tristim::test::reference_identity_test
