#include "scene_folder.h"

#include "scene/geometry.h"
#include "spectra/colour.h"

#include <cmath>

namespace tristim {
namespace {

using test::SceneFolder;
using test::with_world;

constexpr double pi = M_PI;

/// Quotients of integrals over 400 bins in double precision agree to far better than this.
constexpr double tight = 1e-9;

double luminance(const Spectrum& spectrum) {
    return spectrum_to_xyz(spectrum)[1];
}

Light light_of(const std::string& directives) {
    const SceneFolder folder;
    return folder.load(with_world(directives + " Shape \"sphere\"")).lights.at(0);
}

Material material_of(const std::string& directives) {
    const SceneFolder folder;
    const Scene scene = folder.load(with_world("LightSource \"point\" " + directives + " Shape \"sphere\""));
    return scene.materials.at(static_cast<std::size_t>(scene.shapes.at(0).material));
}

TEST(SceneLight, SpotWithSpectrumOfD65HasIntensityOfItsScale) {
    const Light light = light_of("LightSource \"spot\" \"spectrum I\" \"stdillum-D65\" \"float scale\" 250 "
                                 "\"point3 from\" [-5 -2.2 6] \"point3 to\" [0 0 0.8] \"float coneangle\" 10 "
                                 "\"float conedeltaangle\" 2");
    EXPECT_EQ(light.kind, Light::Kind::Spot);
    EXPECT_NEAR(luminance(light.emission) * light.scale, 250.0, 250.0 * tight);
    EXPECT_EQ(light.position, V3d(-5, -2.2, 6));
    const V3d axis = V3d(5, 2.2, -5.2).normalized();
    EXPECT_NEAR((light.direction - axis).length(), 0.0, 1e-15);
    EXPECT_NEAR(light.cos_total_width, std::cos(10.0 * pi / 180.0), 1e-15);
    EXPECT_NEAR(light.cos_falloff_start, std::cos(8.0 * pi / 180.0), 1e-15);
}

TEST(SceneLight, DefaultsAreThoseOfPbrt) {
    const Light spot = light_of("LightSource \"spot\"");
    EXPECT_EQ(spot.position, V3d(0, 0, 0));
    EXPECT_EQ(spot.direction, V3d(0, 0, 1));
    EXPECT_NEAR(spot.cos_total_width, std::cos(30.0 * pi / 180.0), 1e-15);
    EXPECT_NEAR(spot.cos_falloff_start, std::cos(25.0 * pi / 180.0), 1e-15);
    EXPECT_EQ(spot.scale, 1.0);
    const Spectrum d65 = Spectrum::named("stdillum-D65");
    EXPECT_NEAR(spot.emission(560.0), d65(560.0) / luminance(d65), tight);
    EXPECT_EQ(light_of("LightSource \"distant\"").direction, V3d(0, 0, 1));
    EXPECT_EQ(light_of("LightSource \"infinite\"").kind, Light::Kind::Infinite);
}

TEST(SceneLight, EverySpectrumTypeIsNormalisedToUnitLuminance) {
    for (const char* spectrum :
         {"\"spectrum I\" [300 5 900 5]", "\"spectrum I\" \"stdillum-F11\"", "\"blackbody I\" 3000"})
        EXPECT_NEAR(luminance(light_of(std::string("LightSource \"point\" ") + spectrum).emission), 1.0, tight)
            << spectrum;
}

TEST(SceneLight, RgbIsNormalisedByItsWhiteOnly) {
    const Light light = light_of("LightSource \"point\" \"rgb I\" [0.2 0.4 0.1]");
    const Spectrum expected = Spectrum::rgb_illuminant({0.2, 0.4, 0.1});
    const double white = luminance(Spectrum::rgb_illuminant_white());
    for (const double nm : {400.0, 500.0, 600.0, 700.0})
        EXPECT_NEAR(light.emission(nm), expected(nm) / white, tight);
    // The luminance of the linear sRGB colour; upsampling reproduces colours to 1e-3.
    EXPECT_NEAR(luminance(light.emission), rgb_to_xyz({0.2, 0.4, 0.1})[1], 1e-3);
}

TEST(SceneLight, PowerAndIlluminanceScaleAsInPbrt) {
    EXPECT_NEAR(light_of("LightSource \"point\" \"float power\" 12 \"float scale\" 2").scale, 2.0 * 12.0 / (4.0 * pi),
                tight);
    const double start = std::cos(25.0 * pi / 180.0), end = std::cos(30.0 * pi / 180.0);
    EXPECT_NEAR(light_of("LightSource \"spot\" \"float power\" 12").scale,
                12.0 / (2.0 * pi * ((1.0 - start) + (start - end) / 2.0)), tight);
    EXPECT_NEAR(light_of("LightSource \"infinite\" \"float illuminance\" 12").scale, 12.0 / pi, tight);
    EXPECT_NEAR(light_of("LightSource \"distant\" \"float illuminance\" 12").scale, 12.0, tight);
}

TEST(SceneLight, PositionsAndDirectionsFollowTheTransform) {
    const Light point = light_of("Translate 1 2 3 LightSource \"point\" \"point3 from\" [1 0 0]");
    EXPECT_EQ(point.position, V3d(2, 2, 3));
    const Light distant = light_of("Rotate 90 0 1 0 LightSource \"distant\"");
    EXPECT_NEAR((distant.direction - V3d(1, 0, 0)).length(), 0.0, 1e-15);
    const Light along = light_of("LightSource \"distant\" \"point3 from\" [0 0 5] \"point3 to\" [3 0 1]");
    EXPECT_NEAR((along.direction - V3d(0.6, 0, -0.8)).length(), 0.0, 1e-15);
    const Light spot = light_of("Translate 0 0 7 Scale 2 2 -2 LightSource \"spot\"");
    EXPECT_EQ(spot.position, V3d(0, 0, 7));
    EXPECT_EQ(spot.direction, V3d(0, 0, -1));
}

TEST(SceneAreaLight, BelongsToTheShapesOfItsBlock) {
    const SceneFolder folder;
    const Scene scene =
        folder.load(with_world("AttributeBegin\nAreaLightSource \"diffuse\" \"float scale\" 3 \"bool twosided\" true\n"
                               "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 2 0 0 0 3 0 2 3 0]\n"
                               "Shape \"sphere\"\nAttributeEnd\nShape \"sphere\""));
    ASSERT_EQ(scene.lights.size(), 2u);
    EXPECT_EQ(scene.shapes[0].area_light, 0);
    EXPECT_EQ(scene.shapes[1].area_light, 1);
    EXPECT_EQ(scene.shapes[2].area_light, -1);
    EXPECT_EQ(scene.lights[0].kind, Light::Kind::Area);
    EXPECT_TRUE(scene.lights[0].two_sided);
    EXPECT_NEAR(scene.lights[0].scale * luminance(scene.lights[0].emission), 3.0, 3.0 * tight);
}

TEST(SceneAreaLight, PowerIsMeantForEachTriangleOrPatch) {
    const SceneFolder folder;
    const Scene patch = folder.load(with_world("AreaLightSource \"diffuse\" \"float power\" 5\n"
                                               "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 2 0 0 0 3 0 2 3 0]"));
    ASSERT_EQ(patch.lights.size(), 1u);
    EXPECT_NEAR(patch.lights[0].scale, 5.0 / (pi * 6.0), 1e-7);

    const Scene triangles = folder.load(with_world(
        "AreaLightSource \"diffuse\" \"float power\" 5 \"bool twosided\" true\n"
        "Shape \"trianglemesh\" \"integer indices\" [0 1 2  1 3 2] \"point3 P\" [0 0 0  2 0 0  0 3 0  6 3 0]"));
    ASSERT_EQ(triangles.lights.size(), 2u);
    for (const Shape& shape : triangles.shapes) {
        ASSERT_EQ(shape.mesh.triangles.size(), 1u);
        EXPECT_NEAR(triangles.lights.at(static_cast<std::size_t>(shape.area_light)).scale,
                    5.0 / (2.0 * pi * area(shape.mesh)), 1e-7);
    }
    EXPECT_NEAR(area(triangles.shapes[0].mesh), 3.0, 1e-6);
    EXPECT_NEAR(area(triangles.shapes[1].mesh), 9.0, 1e-6);
}

TEST(SceneMaterial, DefaultIsGreyDiffuse) {
    const Material material = material_of("");
    EXPECT_EQ(material.kind, Material::Kind::Diffuse);
    EXPECT_EQ(material.reflectance(550.0), 0.5);
}

TEST(SceneMaterial, DiffuseTakesRgbPairsAndFiles) {
    EXPECT_NEAR(material_of("Material \"diffuse\" \"rgb reflectance\" [0.25 0.25 0.25]").reflectance(500.0), 0.25,
                1e-6);
    EXPECT_NEAR(material_of("Material \"diffuse\" \"spectrum reflectance\" [400 0 800 1]").reflectance(500.0), 0.25,
                tight);
    const SceneFolder folder;
    folder.write("ramp.spd", "# nm value\n400 0\n800 0.8\n");
    const Scene scene =
        folder.load(with_world("LightSource \"point\" Material \"diffuse\" \"spectrum reflectance\" \"ramp.spd\" "
                               "Shape \"sphere\""));
    EXPECT_NEAR(scene.materials.at(0).reflectance(500.0), 0.2, tight);
}

TEST(SceneMaterial, DielectricTakesNumbersAndNamedGlass) {
    EXPECT_EQ(material_of("Material \"dielectric\"").eta(550.0), 1.5);
    const Material water = material_of("Material \"dielectric\" \"float eta\" 1.33");
    EXPECT_EQ(water.kind, Material::Kind::Dielectric);
    EXPECT_TRUE(water.eta.is_constant());
    EXPECT_EQ(water.eta(550.0), 1.33);
    EXPECT_NEAR(material_of("Material \"dielectric\" \"spectrum eta\" \"glass-BK7\"").eta(587.56), 1.5168, 1e-4);
}

TEST(SceneMaterial, ConductorTakesIndicesOrReflectance) {
    const Material copper = material_of("Material \"conductor\"");
    EXPECT_EQ(copper.kind, Material::Kind::Conductor);
    EXPECT_EQ(copper.eta(550.0), Spectrum::named("metal-Cu-eta")(550.0));
    EXPECT_EQ(copper.k(550.0), Spectrum::named("metal-Cu-k")(550.0));
    const Material mirror = material_of("Material \"conductor\" \"spectrum reflectance\" [300 0.64 900 0.64]");
    EXPECT_EQ(mirror.eta(550.0), 1.0);
    // Normal incidence: R = k² / (4 + k²) for eta = 1.
    const double k = mirror.k(550.5);
    EXPECT_NEAR(k * k / (4.0 + k * k), 0.64, 1e-12);
}

TEST(SceneMaterial, NamedMaterialsMayComeLaterAndUnusedOnesVanish) {
    const SceneFolder folder;
    const Scene scene =
        folder.load(with_world("LightSource \"point\" MakeNamedMaterial \"unused\" \"string type\" \"dielectric\"\n"
                               "NamedMaterial \"late\" Shape \"sphere\"\n"
                               "MakeNamedMaterial \"late\" \"string type\" \"conductor\""));
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].kind, Material::Kind::Conductor);
    EXPECT_EQ(scene.materials[0].name, "late");
}

} // namespace
} // namespace tristim
