// Thin films and roughness of materials, as scene files give them.

#include "scene_folder.h"

#include <cmath>
#include <ostream>

namespace tristim {
namespace {

using test::error_of;
using test::expect_message;
using test::SceneFolder;
using test::with_lit_world;
using test::with_world;

const char* const triangle = "\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n";

/// The material of a triangle after some directives, beside a file "n.spd" that runs from 1.4 at 300 nm to 1.6 at 900.
Material material(const std::string& directives) {
    const SceneFolder folder;
    folder.write("n.spd", "300 1.4\n900 1.6\n");
    const Scene scene = folder.load(with_world("LightSource \"point\"\n" + directives + triangle));
    return scene.materials.at(0);
}

TEST(SceneFilm, MaterialsHaveNoneByDefault) {
    for (const char* kind : {"diffuse", "dielectric", "conductor"}) {
        const Material m = material(fmt::format("Material \"{}\"", kind));
        EXPECT_TRUE(m.film.layers.empty());
        EXPECT_EQ(m.film.thickness_texture, -1);
    }
}

TEST(SceneFilm, OneLayerOfNumbers) {
    const Material m =
        material("Material \"dielectric\" \"float filmthickness\" 500 \"float filmeta\" 1.38 \"float filmk\" 0.01");
    ASSERT_EQ(m.film.layers.size(), 1u);
    EXPECT_EQ(m.film.layers[0].thickness, 500.0);
    EXPECT_EQ(m.film.layers[0].eta(550), 1.38);
    EXPECT_EQ(m.film.layers[0].k(550), 0.01);
    EXPECT_EQ(m.eta(550), 1.5);
}

TEST(SceneFilm, OneLayerOfSpectra) {
    const Material m =
        material("Material \"conductor\" \"float filmthickness\" [0] \"spectrum filmeta\" [300 1.5 900 2.1] "
                 "\"spectrum filmk\" \"n.spd\"");
    ASSERT_EQ(m.film.layers.size(), 1u);
    EXPECT_EQ(m.film.layers[0].thickness, 0.0);
    EXPECT_NEAR(m.film.layers[0].eta(600), 1.8, 1e-15);
    EXPECT_NEAR(m.film.layers[0].k(600), 1.5, 1e-15);
}

TEST(SceneFilm, LayersRunFromTheOutermostInwards) {
    const Material m = material("Material \"conductor\" \"spectrum eta\" \"metal-Ag-eta\" \"float filmthickness\" "
                                "[10 20 30] \"string filmeta\" [\"n.spd\" \"1.38\" \"metal-Au-eta\"] "
                                "\"string filmk\" [\"0\" \"0.5\" \"metal-Au-k\"]");
    ASSERT_EQ(m.film.layers.size(), 3u);
    EXPECT_NEAR(m.film.layers[0].eta(600), 1.5, 1e-15);
    EXPECT_EQ(m.film.layers[1].eta(600), 1.38);
    EXPECT_EQ(m.film.layers[2].eta(600), Spectrum::named("metal-Au-eta")(600));
    EXPECT_EQ(m.film.layers[0].k(600), 0.0);
    EXPECT_EQ(m.film.layers[1].k(600), 0.5);
    EXPECT_EQ(m.film.layers[2].k(600), Spectrum::named("metal-Au-k")(600));
    EXPECT_EQ(m.film.layers[1].thickness, 20.0);
}

TEST(SceneFilm, NumbersMayBeListsToo) {
    const Material m = material(
        "Material \"dielectric\" \"float filmthickness\" [10 20] \"float filmeta\" [1.4 2.3] \"float filmk\" [0 1]");
    EXPECT_EQ(m.film.layers.at(1).eta(500), 2.3);
    EXPECT_EQ(m.film.layers.at(1).k(500), 1.0);
}

TEST(SceneFilm, MaterialNamesBringTheirAbsorption) {
    const Material m =
        material("Material \"dielectric\" \"float filmthickness\" [10 20] \"string filmeta\" [\"SiO2\" \"Ag\"]");
    EXPECT_EQ(m.film.layers.at(0).eta(500), Spectrum::named("film-SiO2-eta")(500));
    EXPECT_EQ(m.film.layers.at(0).k(500), 0.0);
    EXPECT_EQ(m.film.layers.at(1).eta(500), Spectrum::named("metal-Ag-eta")(500));
    EXPECT_EQ(m.film.layers.at(1).k(500), Spectrum::named("metal-Ag-k")(500));
}

TEST(SceneFilm, FilmkStandsInForAMaterialsAbsorption) {
    const std::string film = "Material \"dielectric\" \"float filmthickness\" 10 \"string filmeta\" \"Ag\" ";
    EXPECT_EQ(material(film + "\"float filmk\" 0").film.layers.at(0).k(500), 0.0);
    EXPECT_EQ(material(film + "\"string filmk\" \"Au\"").film.layers.at(0).k(500), Spectrum::named("metal-Au-k")(500));
}

TEST(SceneFilm, CoatedDiffuseSurfacesHaveAnIndexUnderTheFilm) {
    const std::string film = "\"float filmthickness\" 10 \"float filmeta\" 1.3";
    EXPECT_EQ(material("Material \"diffuse\" " + film).eta(500), 1.5);
    EXPECT_EQ(material("Material \"diffuse\" \"float eta\" 1.7 " + film).eta(500), 1.7);
    const Material m =
        material("Material \"diffuse\" \"spectrum eta\" \"glass-BK7\" \"rgb reflectance\" [1 1 1] " + film);
    EXPECT_EQ(m.eta(500), Spectrum::named("glass-BK7")(500));
    EXPECT_NEAR(m.reflectance(500), 1.0, 1e-6);
    EXPECT_EQ(m.film.layers.size(), 1u);
}

TEST(SceneFilm, NamedMaterialsMayHaveOne) {
    const Material m = material("MakeNamedMaterial \"bubble\" \"string type\" \"dielectric\" \"float eta\" 1 "
                                "\"float filmthickness\" 300 \"float filmeta\" 1.33 NamedMaterial \"bubble\"");
    EXPECT_EQ(m.film.layers.at(0).thickness, 300.0);
}

TEST(SceneRoughness, AlphaIsTheRootOfRoughnessUnlessNotRemapped) {
    Material m = material("Material \"dielectric\" \"float roughness\" 0.09");
    EXPECT_DOUBLE_EQ(m.alpha_u, 0.3);
    EXPECT_DOUBLE_EQ(m.alpha_v, 0.3);
    m = material("Material \"conductor\" \"float roughness\" 0.09 \"bool remaproughness\" false");
    EXPECT_EQ(m.alpha_u, 0.09);
    EXPECT_EQ(m.alpha_v, 0.09);
    m = material("Material \"conductor\" \"float uroughness\" 0.25 \"float roughness\" 1");
    EXPECT_DOUBLE_EQ(m.alpha_u, 0.5);
    EXPECT_DOUBLE_EQ(m.alpha_v, 1.0);
    m = material("Material \"conductor\" \"float vroughness\" 0.25");
    EXPECT_EQ(m.alpha_u, 1e-4); // pbrt's narrowest lobe
    EXPECT_DOUBLE_EQ(m.alpha_v, 0.5);
}

TEST(SceneRoughness, SurfacesBelowPbrtsLimitAreSmooth) {
    const auto alphas = [](const std::string& parameters) {
        const Material m = material("Material \"conductor\" \"bool remaproughness\" false " + parameters);
        return std::array{m.alpha_u, m.alpha_v};
    };
    EXPECT_EQ(alphas("\"float roughness\" 0.000999"), (std::array{0.0, 0.0}));
    EXPECT_EQ(alphas("\"float roughness\" 0.001"), (std::array{0.001, 0.001}));
    EXPECT_EQ(alphas("\"float uroughness\" 0.002 \"float vroughness\" 0.00005"), (std::array{0.002, 1e-4}));
    EXPECT_EQ(alphas("\"float uroughness\" 0.0005 \"float vroughness\" 0.00005"), (std::array{0.0, 0.0}));
}

struct BadMaterial {
    const char* label;
    std::string text;  ///< stands at line 5
    const char* words; ///< that the message must hold
};

void PrintTo(const BadMaterial& bad, std::ostream* out) {
    *out << bad.label;
}

class FilmError : public testing::TestWithParam<BadMaterial> {};

TEST_P(FilmError, NamesFileLineAndReason) {
    const SceneFolder folder;
    folder.write("short.spd", "400 1.5\n700 1.5\n");
    folder.write("negative.spd", "300 1\n800 -0.1\n");
    const std::string message = error_of([&] { folder.load(with_lit_world(GetParam().text)); });
    expect_message(message, folder.path("scene.pbrt") + ":5: ", GetParam().words);
}

std::string glass(const std::string& parameters) {
    return "Material \"dielectric\" " + parameters;
}
std::string layer(const std::string& thickness, const std::string& rest = "\"float filmeta\" 1.4") {
    return glass("\"float filmthickness\" " + thickness + " " + rest);
}

INSTANTIATE_TEST_SUITE_P(
    , FilmError,
    testing::Values(
        BadMaterial{"NegativeThickness", layer("-1"), "film thickness -1 nm"},
        BadMaterial{"TooThick", layer("2e6"),
                    "film thickness 2000000 nm in \"filmthickness\" must be from 0 to 1000000 nm"},
        BadMaterial{"SecondThicknessNegative", layer("[10 -2]", "\"float filmeta\" [1.4 1.5]"), "film thickness -2 nm"},
        BadMaterial{"NanThickness", layer("nan"), "\"nan\" in the parameter \"filmthickness\""},
        BadMaterial{"InfiniteThickness", layer("[ inf ]"), "\"inf\" in the parameter \"filmthickness\""},
        BadMaterial{"HugeThickness", layer("1e39"), "finite"},
        BadMaterial{"ThicknessWithUnit", layer("\"500nm\""), "\"500nm\" in the parameter \"filmthickness\""},
        BadMaterial{"NoThicknesses", layer("[ ]"), "\"filmthickness\""},
        BadMaterial{"WrongType", glass("\"integer filmthickness\" 3 \"float filmeta\" 1.4"), "\"integer\""},
        BadMaterial{"MoreThicknesses", layer("[1 2]"), "\"filmeta\" has 1 value, but \"filmthickness\" has 2"},
        BadMaterial{"MoreIndices", layer("1", "\"string filmeta\" [\"SiO2\" \"Ag\" \"1.5\"]"),
                    "\"filmeta\" has 3 values, but \"filmthickness\" has 1"},
        BadMaterial{"SpectrumForTwo", layer("[1 2]", "\"spectrum filmeta\" \"glass-BK7\""), "\"filmeta\" has 1 value"},
        BadMaterial{"MoreAbsorptions", layer("1", "\"float filmeta\" 1.5 \"float filmk\" [0 0]"),
                    "\"filmk\" has 2 values, but \"filmthickness\" has 1"},
        BadMaterial{"FewerAbsorptions", layer("[1 2]", "\"float filmeta\" [1 2] \"string filmk\" \"0\""),
                    "\"filmk\" has 1 value, but \"filmthickness\" has 2"},
        BadMaterial{"NoIndex", layer("1", ""), "no \"filmeta\""},
        BadMaterial{"NoThickness", glass("\"float filmeta\" 1.4"), "no \"filmthickness\""},
        BadMaterial{"OnlyAbsorption", glass("\"float filmk\" 1.4"), "no \"filmthickness\""},
        BadMaterial{"ZeroIndex", layer("1", "\"float filmeta\" 0"), "\"filmeta\" is 0, but it must be positive"},
        BadMaterial{"NegativeIndex", layer("1", "\"spectrum filmeta\" [300 -1 900 -1]"), "must be positive"},
        BadMaterial{"NegativeIndexName", layer("1", "\"string filmeta\" \"-1.5\""), "-1.5"},
        BadMaterial{"NegativeAbsorption", layer("1", "\"float filmeta\" 1.4 \"float filmk\" -0.1"),
                    "\"filmk\" is -0.1, but it must be at least 0"},
        BadMaterial{"NegativeAbsorptionFile", layer("1", "\"float filmeta\" 1.4 \"string filmk\" \"negative.spd\""),
                    "negative.spd"},
        BadMaterial{"InfiniteAbsorption", layer("1", "\"float filmeta\" 1.4 \"string filmk\" \"inf\""), "inf"},
        BadMaterial{"ShortSpectrum", layer("1", "\"spectrum filmeta\" [400 1.5 700 1.5]"),
                    "covers only 400 to 700 nm, not all of 380 to 780 nm"},
        BadMaterial{"ShortFile", layer("1", "\"string filmeta\" \"short.spd\""), "400 to 700 nm"},
        BadMaterial{"ShortAbsorption", layer("1", "\"float filmeta\" 1.4 \"string filmk\" \"short.spd\""),
                    "400 to 700 nm"},
        BadMaterial{"UnknownMaterial", layer("1", "\"string filmeta\" \"SiO3\""), "SiO2"},
        BadMaterial{"UnknownAbsorption", layer("1", "\"float filmeta\" 1.4 \"string filmk\" \"SiO3\""), "SiO2"},
        BadMaterial{"UnknownSpectrum", layer("1", "\"spectrum filmeta\" \"glass-BK8\""), "glass-BK7"},
        BadMaterial{"MissingFile", layer("1", "\"string filmeta\" \"absent.spd\""), "absent.spd"},
        BadMaterial{"UnknownTexture", glass("\"texture filmthickness\" \"wedge\" \"float filmeta\" 1.4"),
                    "no texture \"wedge\" is defined"},
        BadMaterial{"TextureForIndex", layer("1", "\"texture filmeta\" \"wedge\""), "only \"filmthickness\""},
        BadMaterial{"OtherMaterial", "Material \"thindielectric\" \"float filmthickness\" 1 \"float filmeta\" 1.4",
                    "\"thindielectric\" is not supported"},
        BadMaterial{"IndexWithoutFilm", "Material \"diffuse\" \"float eta\" 1.4", "no \"filmthickness\""},
        BadMaterial{"ZeroCoatedIndex",
                    "Material \"diffuse\" \"float eta\" 0 \"float filmthickness\" 1 \"float filmeta\" 1.4",
                    "\"eta\" is 0"},
        BadMaterial{"CoatedAbsorption",
                    "Material \"diffuse\" \"float k\" 1 \"float filmthickness\" 1 \"float filmeta\" 1.4", "\"k\""},
        BadMaterial{"NegativeRoughness", glass("\"float roughness\" -0.1"), "roughness"},
        BadMaterial{"LargeRoughness", glass("\"float vroughness\" 1.1"), "roughness"},
        BadMaterial{"InfiniteRoughness", glass("\"float uroughness\" inf"), "\"inf\" in the parameter \"uroughness\""},
        BadMaterial{"TextureRoughness", glass("\"texture roughness\" \"wedge\""), "only \"filmthickness\""},
        BadMaterial{"DiffuseRoughness", "Material \"diffuse\" \"float roughness\" 0.1", "roughness"}),
    [](const auto& bad) { return bad.param.label; });

} // namespace
} // namespace tristim
