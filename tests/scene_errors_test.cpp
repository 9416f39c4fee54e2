#include "scene_folder.h"

#include <ostream>

namespace tristim {
namespace {

using test::error_of;
using test::expect_message;
using test::SceneFolder;
using test::with_lit_world;
using test::with_world;

struct BadScene {
    const char* label;
    std::string text;
    int line;         ///< that the message must name; 0: the file alone
    const char* word; ///< that the message must hold
};

void PrintTo(const BadScene& scene, std::ostream* out) {
    *out << scene.label;
}

class SceneError : public testing::TestWithParam<BadScene> {};

TEST_P(SceneError, NamesFileLineAndWord) {
    const SceneFolder folder;
    folder.write("broken.spd", "400 1\n500 banana\n");
    const BadScene& bad = GetParam();
    const std::string message = error_of([&] { folder.load(bad.text); });
    const std::string file = folder.path("scene.pbrt");
    const std::string start = bad.line > 0 ? file + ":" + std::to_string(bad.line) + ": " : file + ": ";
    expect_message(message, start, bad.word);
}

std::string label_of(const testing::TestParamInfo<BadScene>& info) {
    return info.param.label;
}

/// A world piece that stands at line 5.
BadScene world(const char* label, const std::string& piece, const char* word) {
    return {label, with_lit_world(piece), 5, word};
}

INSTANTIATE_TEST_SUITE_P(
    Syntax, SceneError,
    testing::Values(
        BadScene{"UnknownDirective", "\nFrobnicate 1\n", 2, "Frobnicate"},
        BadScene{"UnsupportedDirective", with_lit_world("MakeNamedMedium \"fog\""), 5, "MakeNamedMedium"},
        BadScene{"StrayString", "\"Camera\"", 1, "Camera"}, BadScene{"StrayBracket", "\n\n]", 3, "]"},
        BadScene{"UnterminatedString", "Camera \"persp\nWorldBegin", 1, "persp"},
        BadScene{"UnknownEscape", "Camera \"a\\q\"", 1, "q"}, BadScene{"MissingPluginName", "Camera [1]", 1, "Camera"},
        BadScene{"MissingNumber", "Translate 1 2\nWorldBegin", 2, "WorldBegin"},
        BadScene{"WordForNumber", "Translate 1 abc 2", 1, "abc"},
        BadScene{"InfiniteNumber", "Translate 1 1e400 2", 1, "1e400"}, BadScene{"NanNumber", "Scale nan 1 1", 1, "nan"},
        BadScene{"NumberWithTail", "Scale 1x 1 1", 1, "1x"},
        BadScene{"NanParameter", "Camera \"perspective\"\n\"float fov\" [ nan ]", 2, "nan"},
        BadScene{"InfParameter", "Camera \"perspective\"\n\"float fov\" inf", 2, "inf"},
        BadScene{"ShortMatrix", "Transform [1 2 3]", 1, "Transform"},
        BadScene{"OpenBrackets", "Camera \"perspective\" \"float fov\" [ 3", 1, "fov"},
        BadScene{"NoValue", "Camera \"perspective\" \"float fov\"", 1, "fov"},
        BadScene{"NoParameterName", "Camera \"perspective\" \"float\" 3", 1, "float"},
        BadScene{"UnknownType", "Camera \"perspective\" \"double fov\" 3", 1, "double"},
        BadScene{"UnknownParameter", "Camera \"perspective\"\n\"float zoom\" 3", 2, "zoom"},
        BadScene{"WrongType", "Camera \"perspective\"\n\"integer fov\" 3", 2, "fov"},
        BadScene{"TwiceTheSame", "Camera \"perspective\" \"float fov\" 3\n\"float fov\" 4", 2, "fov"},
        BadScene{"TooManyValues", "Camera \"perspective\" \"float fov\" [3 4]", 1, "fov"},
        BadScene{"FractionForInteger", "Film \"rgb\" \"integer xresolution\" 1.5", 1, "1.5"},
        BadScene{"QuotedNumber", "Film \"rgb\" \"integer xresolution\" \"5\"", 1, "5"},
        BadScene{"BareString", "Film \"rgb\" \"string filename\" out.exr", 1, "out.exr"},
        BadScene{"BadBool", "Film \"rgb\" \"bool savefp16\" maybe", 1, "maybe"},
        BadScene{"SelfInclude", "Include \"scene.pbrt\"", 1, "scene.pbrt"},
        BadScene{"MissingInclude", "\nInclude \"absent.pbrt\"", 2, "absent.pbrt"},
        BadScene{"UnclosedBlock", with_lit_world("AttributeBegin"), 5, "never closed"},
        BadScene{"UnopenedBlock", with_lit_world("AttributeEnd"), 5, "AttributeEnd"},
        BadScene{"CrossedBlocks", with_lit_world("AttributeBegin TransformBegin\nAttributeEnd"), 6, "AttributeEnd"},
        BadScene{"WorldDirectiveTooEarly", "Shape \"sphere\"", 1, "Shape"},
        BadScene{"OptionTooLate", with_lit_world("Film \"rgb\""), 5, "Film"},
        BadScene{"UnknownOption", "Option \"bool forcediffuse\" true", 1, "forcediffuse"},
        BadScene{"UnknownRgbUpsampling", "\nOption \"string rgbupsampling\" \"smits\"", 2, "smits"},
        BadScene{"RgbUpsamplingOfAnotherType", "Option \"bool rgbupsampling\" true", 1, "rgbupsampling"}),
    label_of);

INSTANTIATE_TEST_SUITE_P(Whole, SceneError,
                         testing::Values(BadScene{"NoCamera", "WorldBegin LightSource \"point\" Shape \"sphere\"", 0,
                                                  "no camera"},
                                         BadScene{"NoLight", with_world("Shape \"sphere\""), 0, "no light"},
                                         BadScene{"NoGeometry", with_world("LightSource \"point\""), 0, "no geometry"},
                                         BadScene{"NoWorld", "Camera \"perspective\"", 0, "WorldBegin"},
                                         BadScene{"Empty", "", 0, "no camera"}),
                         label_of);

INSTANTIATE_TEST_SUITE_P(
    Settings, SceneError,
    testing::Values(BadScene{"ZeroResolution", "\nFilm \"rgb\" \"integer xresolution\" 0", 2, "xresolution"},
                    BadScene{"NegativeResolution", "Film \"rgb\" \"integer yresolution\" -4", 1, "yresolution"},
                    BadScene{"CropWindow", "Film \"rgb\" \"float cropwindow\" [0 1 0 1]", 1, "cropwindow"},
                    BadScene{"Exposure", "Film \"rgb\" \"float iso\" 200", 1, "iso"},
                    BadScene{"Sensor", "Film \"rgb\" \"string sensor\" \"canon_eos_5d\"", 1, "canon_eos_5d"},
                    BadScene{"OtherFilm", "Film \"spectral\"", 1, "spectral"},
                    BadScene{"OtherCamera", "Camera \"spherical\"", 1, "spherical"},
                    BadScene{"FlatFov", "Camera \"perspective\" \"float fov\" 180", 1, "fov"},
                    BadScene{"SingularCamera", "Scale 1 0 1\nCamera \"perspective\"", 2, "transformation"},
                    BadScene{"LookAtNowhere", "LookAt 1 2 3  1 2 3  0 0 1", 1, "LookAt"},
                    BadScene{"LookAtAlongUp", "LookAt 0 0 0  0 0 1  0 0 2", 1, "LookAt"},
                    BadScene{"RotateAboutNothing", "Rotate 90 0 0 0", 1, "Rotate"},
                    BadScene{"ZeroRadius", "Integrator \"sppm\" \"float radius\" 0", 1, "radius"},
                    BadScene{"NoPhotons", "Integrator \"sppm\" \"integer photonsperiteration\" 0", 1,
                             "photonsperiteration"},
                    BadScene{"OtherIntegrator", "Integrator \"magic\"", 1, "magic"},
                    BadScene{"OtherSampler", "Sampler \"magic\"", 1, "magic"},
                    BadScene{"OtherColorSpace", "ColorSpace \"rec2020\"", 1, "rec2020"},
                    BadScene{"UnknownCoordinates", "CoordSysTransform \"nowhere\"", 1, "nowhere"}),
    label_of);

INSTANTIATE_TEST_SUITE_P(
    Materials, SceneError,
    testing::Values(
        world("UnknownMaterial", "Material \"velvet\"", "velvet"),
        world("InterfaceMaterial", "Material \"interface\"", "interface"),
        world("UndefinedName", "NamedMaterial \"gold\"\nShape \"sphere\"", "gold"),
        world("DefinedTwice",
              "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" MakeNamedMaterial \"a\" "
              "\"string type\" \"diffuse\"",
              "\"a\""),
        world("NoMaterialType", "MakeNamedMaterial \"a\"", "type"),
        world("TextureParameter", "Material \"diffuse\" \"texture reflectance\" \"wood\"", "texture"),
        world("ReflectanceAboveOne", "Material \"diffuse\" \"spectrum reflectance\" [300 0.5 900 1.5]", "reflectance"),
        world("NegativeReflectance", "Material \"diffuse\" \"spectrum reflectance\" [300 -0.5 900 1]", "reflectance"),
        world("RgbAboveOne", "Material \"diffuse\" \"rgb reflectance\" [0 0 1.5]", "1.5"),
        world("TwoColours", "Material \"diffuse\" \"rgb reflectance\" [0 0]", "reflectance"),
        world("OddPairs", "Material \"diffuse\" \"spectrum reflectance\" [400 1 500]", "reflectance"),
        world("DescendingPairs", "Material \"diffuse\" \"spectrum reflectance\" [500 1 400 1]", "400"),
        world("NonFiniteSpectrum", "Material \"diffuse\" \"spectrum reflectance\" [400 nan 800 1]", "nan"),
        world("UnknownSpectrum", "Material \"dielectric\" \"spectrum eta\" \"glass-BK8\"", "glass-BK8"),
        world("MissingSpd", "Material \"dielectric\" \"spectrum eta\" \"absent.spd\"", "absent.spd"),
        world("BrokenSpd", "Material \"dielectric\" \"spectrum eta\" \"broken.spd\"", "broken.spd:2"),
        world("ShortIndex", "Material \"dielectric\" \"spectrum eta\" [400 1.5 700 1.5]", "eta"),
        world("ZeroIndex", "Material \"dielectric\" \"float eta\" 0", "eta"),
        world("NegativeK", "Material \"conductor\" \"spectrum k\" [300 -1 900 -1]", "\"k\""),
        world("ReflectanceAndK", "Material \"conductor\" \"rgb reflectance\" [1 1 1] \"spectrum k\" [300 1 900 1]",
              "\"k\""),
        world("ColdBlackbody", "Material \"diffuse\" \"blackbody reflectance\" 0", "temperature")),
    label_of);

INSTANTIATE_TEST_SUITE_P(
    Lights, SceneError,
    testing::Values(world("UnknownLight", "LightSource \"laser\"", "laser"),
                    world("ImageLight", "LightSource \"infinite\" \"string filename\" \"sky.exr\"", "filename"),
                    world("GoniometricPower", "LightSource \"distant\" \"float power\" 1", "power"),
                    world("BlackRgb", "LightSource \"point\" \"rgb I\" [0 0 0]", "zero"),
                    world("InvisibleSpectrum", "LightSource \"point\" \"spectrum I\" [300 1 350 1]", "zero"),
                    world("NegativeSpectrum", "LightSource \"point\" \"spectrum I\" [300 1 500 -1 900 1]", "negative"),
                    world("NonFiniteEmission", "LightSource \"point\" \"spectrum I\" [300 1 900 1e999]", "1e999"),
                    world("ZeroScale", "LightSource \"point\" \"float scale\" 0", "scale"),
                    world("ZeroPower", "LightSource \"point\" \"float power\" 0", "power"),
                    world("WideCone", "LightSource \"spot\" \"float coneangle\" 200", "coneangle"),
                    world("WideDelta", "LightSource \"spot\" \"float coneangle\" 3", "conedeltaangle"),
                    world("SpotNowhere", "LightSource \"spot\" \"point3 from\" [0 0 1]", "from"),
                    world("SquashedSpot", "Scale 1 2 1 LightSource \"spot\"", "spot"),
                    world("UnknownAreaLight", "AreaLightSource \"neon\"", "neon"),
                    world("ImageAreaLight", "AreaLightSource \"diffuse\" \"string filename\" \"tv.png\"", "filename"),
                    world("ZeroAreaLight",
                          "AreaLightSource \"diffuse\" Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 1 1 2 2 2]",
                          "zero-area light")),
    label_of);

INSTANTIATE_TEST_SUITE_P(
    Shapes, SceneError,
    testing::Values(
        world("UnknownShape", "Shape \"cylinder\"", "cylinder"), world("NoVertices", "Shape \"trianglemesh\"", "P"),
        world("TwoNumbers", "Shape \"trianglemesh\" \"point3 P\" [0 0]", "\"P\""),
        world("NoIndices", "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1]", "indices"),
        world("TwoIndices", "Shape \"trianglemesh\" \"integer indices\" [0 1] \"point3 P\" [0 0 0 1 0 0 0 1 0]",
              "indices"),
        world("IndexTooLarge", "Shape \"trianglemesh\" \"integer indices\" [0 1 7] \"point3 P\" [0 0 0 1 0 0 0 1 0]",
              "7"),
        world("NegativeIndex", "Shape \"trianglemesh\" \"integer indices\" [0 1 -1] \"point3 P\" [0 0 0 1 0 0 0 1 0]",
              "-1"),
        world("NormalsMissing", "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [0 0 1]", "N"),
        world("Alpha", "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"float alpha\" 0.5", "alpha"),
        world("HugeVertex", "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1e300 0 0 0 1 0]", "too large"),
        world("BentPatch", "Shape \"bilinearmesh\" \"point3 P\" [0 0 0  1 0 0  0 1 0  1 1 0.1]", "planar"),
        world("CrossedPatch", "Shape \"bilinearmesh\" \"point3 P\" [0 0 0  1 0 0  1 1 0  0 1 0]", "convex"),
        world("FlatSphere", "Shape \"sphere\" \"float radius\" -1", "radius"),
        world("HalfSphere", "Shape \"sphere\" \"float zmin\" 0", "full spheres"),
        world("SingularTransform", "Scale 1 1 0 Shape \"sphere\"", "transformation"),
        world("NoFileName", "Shape \"plymesh\"", "filename"),
        world("MissingMesh", "Shape \"plymesh\" \"string filename\" \"absent.ply\"", "absent.ply"),
        world("NestedObject", "ObjectBegin \"a\" ObjectBegin \"b\"", "ObjectBegin"),
        world("NestedInstance", "ObjectBegin \"a\" ObjectInstance \"a\"", "ObjectInstance"),
        world("UnknownObject", "ObjectInstance \"ghost\"", "ghost"),
        world("EmissiveObject", "AreaLightSource \"diffuse\" ObjectBegin \"a\" Shape \"sphere\"", "area light"),
        world("LightInObject", "ObjectBegin \"a\" LightSource \"point\"", "light")),
    label_of);

TEST(SceneFile, MissingOrUnreadableFilesAreNamed) {
    const SceneFolder folder;
    const std::string absent = folder.path("absent.pbrt");
    EXPECT_NE(error_of([&] { load_scene(absent); }).find(absent), std::string::npos);
    EXPECT_NE(error_of([&] { load_scene(folder.path("")); }).find("folder"), std::string::npos);
}

TEST(SceneFile, ErrorsInIncludesNameTheIncludedFile) {
    const SceneFolder folder;
    folder.write("part.pbrt", "\n\nFrobnicate\n");
    const std::string message = error_of([&] { folder.load(with_lit_world("Include \"part.pbrt\"")); });
    EXPECT_EQ(message.rfind(folder.path("part.pbrt") + ":3: ", 0), 0u) << message;
}

TEST(SceneFile, CircularIncludesEnd) {
    const SceneFolder folder;
    folder.write("a.pbrt", "Include \"b.pbrt\"\n");
    folder.write("b.pbrt", "\nInclude \"a.pbrt\"\n");
    const std::string message = error_of([&] { folder.load("Include \"a.pbrt\""); });
    EXPECT_EQ(message.rfind(folder.path("b.pbrt") + ":2: ", 0), 0u) << message;
}

} // namespace
} // namespace tristim
