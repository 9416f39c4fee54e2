#include "scene_folder.h"

#include "scene/geometry.h"
#include "scene/tokenizer.h"

#include <cmath>

namespace tristim {
namespace {

using test::SceneFolder;
using test::with_lit_world;
using test::with_world;

/// Positions pass through float: seven digits of numbers near 1.
constexpr double float_tolerance = 1e-6;

void expect_near(const V3d& actual, const V3d& expected, double tolerance = float_tolerance) {
    EXPECT_NEAR(actual.x, expected.x, tolerance);
    EXPECT_NEAR(actual.y, expected.y, tolerance);
    EXPECT_NEAR(actual.z, expected.z, tolerance);
}

V3d normal_of(const Mesh& mesh, std::size_t triangle = 0) {
    const auto& [a, b, c] = mesh.triangles.at(triangle);
    const V3d v0(mesh.positions[a]), v1(mesh.positions[b]), v2(mesh.positions[c]);
    return (v1 - v0).cross(v2 - v0).normalized();
}

/// The mesh of a unit right triangle in the plane z = 0 after some directives.
Mesh triangle_after(const std::string& directives, const std::string& more_parameters = "") {
    const SceneFolder folder;
    const Scene scene = folder.load(with_world("LightSource \"point\"\n" + directives +
                                               "\nShape \"trianglemesh\" \"point3 P\" [0 0 0  1 0 0  0 1 0] " +
                                               more_parameters + "\n"));
    return scene.shapes.at(0).mesh;
}

TEST(SceneTokenizer, SplitsWordsStringsBracketsAndComments) {
    const SceneFolder folder;
    Tokenizer tokenizer(folder.write("a", "Shape\"a \\\"b\\\" \\\\\"[1.5# comment \"x\"\n-2]#end"));
    const auto expect = [&](Token::Kind kind, const std::string& text, int line) {
        const Token token = tokenizer.next();
        EXPECT_EQ(token.kind, kind);
        EXPECT_EQ(token.text, text);
        EXPECT_EQ(token.where.line, line);
    };
    expect(Token::Kind::Word, "Shape", 1);
    expect(Token::Kind::String, "a \"b\" \\", 1);
    expect(Token::Kind::OpenBracket, "[", 1);
    expect(Token::Kind::Word, "1.5", 1);
    expect(Token::Kind::Word, "-2", 2);
    expect(Token::Kind::CloseBracket, "]", 2);
    expect(Token::Kind::End, "", 2);
    expect(Token::Kind::End, "", 2);
}

TEST(SceneTransform, TranslateScaleRotateApplyInPbrtsOrder) {
    // pbrt: CTM = T · R · S, so that points are scaled first, then turned, then moved.
    const Mesh mesh = triangle_after("Translate 10 0 0 Rotate 90 0 0 1 Scale 2 3 1");
    expect_near(V3d(mesh.positions[0]), {10, 0, 0}, 1e-5);
    expect_near(V3d(mesh.positions[1]), {10, 2, 0}, 1e-5);
    expect_near(V3d(mesh.positions[2]), {7, 0, 0}, 1e-5);
}

TEST(SceneTransform, TransformListsColumnsAndReplacesWhileConcatTransformAppends) {
    const Mesh replaced = triangle_after("Translate 5 5 5 Transform [2 0 0 0  0 2 0 0  0 0 2 0  1 2 3 1]");
    expect_near(V3d(replaced.positions[1]), {3, 2, 3});
    const Mesh appended = triangle_after("Translate 5 5 5 ConcatTransform [2 0 0 0  0 2 0 0  0 0 2 0  1 2 3 1]");
    expect_near(V3d(appended.positions[1]), {8, 7, 8});
}

TEST(SceneTransform, AttributeBlocksRestoreEverythingAndTransformBlocksTheTransformOnly) {
    const SceneFolder folder;
    const std::string triangle = "Shape \"trianglemesh\" \"point3 P\" [0 0 0  1 0 0  0 1 0]\n";
    const Scene scene = folder.load(with_world("LightSource \"point\"\nMaterial \"dielectric\"\n"
                                               "AttributeBegin Translate 1 0 0 Material \"diffuse\"\n" +
                                               triangle + "AttributeEnd\n" + triangle +
                                               "TransformBegin Translate 2 0 0 Material \"conductor\"\n" + triangle +
                                               "TransformEnd\n" + triangle));
    ASSERT_EQ(scene.shapes.size(), 4u);
    const auto kind = [&](std::size_t i) {
        return scene.materials.at(static_cast<std::size_t>(scene.shapes[i].material)).kind;
    };
    const auto x = [&](std::size_t i) { return scene.shapes[i].mesh.positions[0].x; };
    EXPECT_EQ(kind(0), Material::Kind::Diffuse);
    EXPECT_EQ(kind(1), Material::Kind::Dielectric);
    EXPECT_EQ(kind(2), Material::Kind::Conductor);
    EXPECT_EQ(kind(3), Material::Kind::Conductor);
    EXPECT_EQ(x(0), 1.0f);
    EXPECT_EQ(x(1), 0.0f);
    EXPECT_EQ(x(2), 2.0f);
    EXPECT_EQ(x(3), 0.0f);
}

TEST(SceneTransform, CoordinateSystemsAreNamedAndRecalled) {
    expect_near(V3d(triangle_after("Translate 1 2 3 CoordinateSystem \"here\" Identity CoordSysTransform \"here\"")
                        .positions[0]),
                {1, 2, 3});
    const SceneFolder folder;
    const Scene scene =
        folder.load("Translate 0 0 -4 Camera \"perspective\" WorldBegin LightSource \"point\" "
                    "CoordSysTransform \"camera\" Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]");
    // The camera stands at z = 4, and "camera" leads from its space to the world.
    expect_near(V3d(scene.shapes[0].mesh.positions[0]), {0, 0, 4});
}

TEST(SceneCamera, LookAtGivesPbrtsLeftHandedFrame) {
    const SceneFolder folder;
    const Scene scene = folder.load("LookAt 1 2 3  1 2 10  0 1 0\n" + with_lit_world(""));
    const M44d& m = scene.camera.camera_to_world;
    // Looking along +z with y up, pbrt's x axis is +x.
    expect_near(V3d(0, 0, 0) * m, {1, 2, 3}, 1e-14);
    expect_near(V3d(1, 0, 0) * m, {2, 2, 3}, 1e-14);
    expect_near(V3d(0, 1, 0) * m, {1, 3, 3}, 1e-14);
    expect_near(V3d(0, 0, 1) * m, {1, 2, 4}, 1e-14);
}

TEST(SceneCamera, ScaleBeforeLookAtMirrorsTheImage) {
    const SceneFolder folder;
    const Scene scene = folder.load("Scale -1 1 1\nLookAt 1 2 3  1 2 10  0 1 0\n" + with_lit_world(""));
    expect_near(V3d(1, 0, 0) * scene.camera.camera_to_world, {0, 2, 3}, 1e-14);
    expect_near(V3d(0, 0, 1) * scene.camera.camera_to_world, {1, 2, 4}, 1e-14);
}

TEST(SceneCamera, ParametersAndDefaults) {
    const SceneFolder folder;
    const Scene plain = folder.load(with_lit_world(""));
    EXPECT_EQ(plain.camera.fov_degrees, 90.0);
    EXPECT_EQ(plain.camera.lens_radius, 0.0);
    EXPECT_EQ(plain.camera.focal_distance, 1e6);
    EXPECT_FALSE(plain.camera.screen_window);
    EXPECT_EQ(plain.settings.width, 1280);
    EXPECT_EQ(plain.settings.height, 720);
    EXPECT_FALSE(plain.settings.max_depth);
    EXPECT_FALSE(plain.settings.initial_radius);

    const Scene full =
        folder.load("Camera \"perspective\" \"float fov\" 33 \"float lensradius\" [0.1] \"float focaldistance\" 4 "
                    "\"float screenwindow\" [-1 1 -2 2]\n"
                    "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" [32] "
                    "\"string filename\" \"out.exr\" \"bool savefp16\" false\n"
                    "Sampler \"halton\" \"integer pixelsamples\" 99 \"integer seed\" 3\n"
                    "Integrator \"sppm\" \"integer photonsperiteration\" 1000 \"float radius\" 0.25\n"
                    "WorldBegin LightSource \"point\" Shape \"sphere\"");
    EXPECT_EQ(full.camera.fov_degrees, 33.0);
    EXPECT_EQ(full.camera.lens_radius, 0.1);
    EXPECT_EQ(full.camera.focal_distance, 4.0);
    EXPECT_EQ(full.camera.screen_window, (std::array<double, 4>{-1, 1, -2, 2}));
    EXPECT_EQ(full.settings.width, 64);
    EXPECT_EQ(full.settings.height, 32);
    EXPECT_EQ(full.settings.filename, "out.exr");
    EXPECT_EQ(full.settings.passes, 99);
    EXPECT_EQ(full.settings.seed, 3u);
    EXPECT_EQ(full.settings.photons_per_pass, 1000);
    EXPECT_EQ(full.settings.initial_radius, 0.25);
    EXPECT_EQ(full.settings.max_depth, 5);
}

TEST(SceneCamera, FrameAspectRatioSetsTheScreenWindow) {
    const SceneFolder folder;
    const Scene wide =
        folder.load("Camera \"perspective\" \"float frameaspectratio\" 2 WorldBegin LightSource \"point\" "
                    "Shape \"sphere\"");
    EXPECT_EQ(wide.camera.screen_window, (std::array<double, 4>{-2, 2, -1, 1}));
    const Scene tall =
        folder.load("Camera \"perspective\" \"float frameaspectratio\" 0.5 WorldBegin LightSource \"point\" "
                    "Shape \"sphere\"");
    EXPECT_EQ(tall.camera.screen_window, (std::array<double, 4>{-1, 1, -2, 2}));
}

TEST(SceneNotes, IgnoredDirectivesAreNotedWithFileAndLine) {
    const SceneFolder folder;
    const Scene scene =
        folder.load("Option \"bool disablepixeljitter\" true\nPixelFilter \"gaussian\"\n\nSampler \"sobol\"\n"
                    "Accelerator \"bvh\"\nIntegrator \"path\" \"integer maxdepth\" 3 \"bool regularize\" true\n" +
                    with_lit_world(""));
    ASSERT_EQ(scene.notes.size(), 5u);
    const std::string file = folder.path("scene.pbrt");
    const std::array<std::string, 5> expected = {":1: the option \"disablepixeljitter\"",
                                                 ":2: PixelFilter \"gaussian\"", ":4: Sampler \"sobol\"",
                                                 ":5: Accelerator \"bvh\"", ":6: Integrator \"path\""};
    for (std::size_t i = 0; i < 5; ++i)
        EXPECT_EQ(scene.notes[i].rfind(file + expected[i], 0), 0u) << scene.notes[i];
    EXPECT_EQ(scene.settings.max_depth, 3);
}

TEST(SceneOrientation, GeometricNormalFollowsMirroringAndReverseOrientation) {
    expect_near(normal_of(triangle_after("")), {0, 0, 1});
    expect_near(normal_of(triangle_after("ReverseOrientation")), {0, 0, -1});
    // The mirror image of a surface keeps its side: (0,0,1) is unchanged by x → −x, and turned by z → −z.
    expect_near(normal_of(triangle_after("Scale -1 1 1")), {0, 0, 1});
    expect_near(normal_of(triangle_after("Scale 1 1 -1")), {0, 0, -1});
    expect_near(normal_of(triangle_after("Scale -1 1 1 ReverseOrientation")), {0, 0, -1});
    expect_near(normal_of(triangle_after("ReverseOrientation ReverseOrientation")), {0, 0, 1});
}

TEST(SceneOrientation, ShadingNormalsDecideTheSideOfTheGeometricNormal) {
    const std::string down = "\"normal N\" [0 0 -1  0 0 -1  0 0 -1]";
    const Mesh mesh = triangle_after("", down);
    expect_near(normal_of(mesh), {0, 0, -1});
    expect_near(V3d(mesh.normals.at(0)), {0, 0, -1});
    const Mesh reversed = triangle_after("ReverseOrientation", down);
    expect_near(normal_of(reversed), {0, 0, 1});
    expect_near(V3d(reversed.normals.at(0)), {0, 0, 1});
    expect_near(normal_of(triangle_after("Scale -1 1 1", down)), {0, 0, -1});
}

TEST(SceneOrientation, NormalsTransformByTheInverseTranspose) {
    // The plane x + z = 0 … const after stretching x by 2: normal (1/2, 0, 1), normalised.
    const Mesh mesh = triangle_after("Scale 2 1 1", "\"normal N\" [1 0 1  1 0 1  1 0 1]");
    const V3d expected = V3d(0.5, 0, 1).normalized();
    for (const V3f& normal : mesh.normals)
        expect_near(V3d(normal), expected);
}

TEST(SceneShape, BilinearPatchHasPbrtsNormalAndArea) {
    const SceneFolder folder;
    const Scene scene = folder.load(
        with_world("LightSource \"point\"\nShape \"bilinearmesh\" \"point3 P\" [0 0 0  2 0 0  0 3 0  2 3 0]\n"
                   "Shape \"bilinearmesh\" \"integer indices\" [0 2 1 3] \"point3 P\" [0 0 0  2 0 0  0 3 0  2 3 0]\n"));
    // (p10 − p00) × (p01 − p00)
    const std::array<double, 2> z = {1, -1};
    for (std::size_t i = 0; i < 2; ++i) {
        const Mesh& mesh = scene.shapes.at(i).mesh;
        ASSERT_EQ(mesh.triangles.size(), 2u);
        expect_near(normal_of(mesh, 0), {0, 0, z[i]});
        expect_near(normal_of(mesh, 1), {0, 0, z[i]});
        EXPECT_NEAR(area(mesh), 6.0, float_tolerance);
    }
}

TEST(SceneShape, SphereIsClosedFacesOutwardAndLiesOnItsRadius) {
    const SceneFolder folder;
    const Scene scene =
        folder.load(with_world("LightSource \"point\" Translate 1 2 3 Shape \"sphere\" \"float radius\" 2"));
    const Mesh& mesh = scene.shapes.at(0).mesh;
    const V3d centre(1, 2, 3);
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const V3d radial = V3d(mesh.positions[i]) - centre;
        // One rounding to float at a coordinate of at most 5.
        EXPECT_NEAR(radial.length(), 2.0, 5 * 1.2e-7);
        EXPECT_NEAR(V3d(mesh.normals[i]).dot(radial.normalized()), 1.0, 1e-6);
    }
    double volume = 0.0;
    for (const auto& [a, b, c] : mesh.triangles)
        volume += (V3d(mesh.positions[a]) - centre)
                      .dot((V3d(mesh.positions[b]) - centre).cross(V3d(mesh.positions[c]) - centre)) /
                  6.0;
    // An inscribed triangle whose edges span the angle δ lies at most δ²/6 below the sphere; here the longest edge has
    // δ = 0.0373 (1.107 rad / 2⁵, stretched by 1.08), and volume loses at most three times that.
    const double exact = 4.0 / 3.0 * M_PI * 8.0;
    EXPECT_LT(volume, exact);
    EXPECT_GT(volume, exact * (1.0 - 3.0 * 0.0373 * 0.0373 / 6.0));
}

TEST(SceneShape, ReversedSphereFacesInward) {
    const SceneFolder folder;
    const Scene scene = folder.load(with_world("LightSource \"point\" ReverseOrientation Shape \"sphere\""));
    const Mesh& mesh = scene.shapes.at(0).mesh;
    EXPECT_LT(V3d(mesh.normals[0]).dot(V3d(mesh.positions[0])), -0.999);
    EXPECT_LT(normal_of(mesh).dot(V3d(mesh.positions[mesh.triangles[0][0]])), -0.99);
}

TEST(SceneShape, DegenerateTrianglesAreDroppedAndCounted) {
    const SceneFolder folder;
    const Scene scene = folder.load(with_world("LightSource \"point\"\nShape \"trianglemesh\" \"integer indices\" "
                                               "[0 1 2  0 1 1  0 3 1] \"point3 P\" [0 0 0  1 0 0  0 1 0  0.5 0 0]"));
    EXPECT_EQ(scene.shapes.at(0).mesh.triangles.size(), 1u);
    ASSERT_EQ(scene.notes.size(), 1u);
    EXPECT_EQ(scene.notes[0], folder.path("scene.pbrt") + ":4: dropped 2 degenerate triangles");
}

TEST(SceneObject, InstancesAreCopiesUnderBothTransforms) {
    const SceneFolder folder;
    const Scene scene =
        folder.load(with_world("LightSource \"point\" Translate 0 0 1\nObjectBegin \"thing\" Scale 2 2 2 "
                               "Material \"dielectric\"\n"
                               "Shape \"trianglemesh\" \"point3 P\" [0 0 0  1 0 0  0 1 0]\nObjectEnd\n"
                               "Identity Translate 5 0 0 ObjectInstance \"thing\"\n"
                               "Identity Scale -1 1 1 ObjectInstance \"thing\"\n"));
    ASSERT_EQ(scene.shapes.size(), 2u);
    expect_near(V3d(scene.shapes[0].mesh.positions[1]), {7, 0, 1});
    expect_near(V3d(scene.shapes[1].mesh.positions[1]), {-2, 0, 1});
    expect_near(normal_of(scene.shapes[1].mesh), {0, 0, 1});
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].kind, Material::Kind::Dielectric);
}

TEST(SceneInclude, FilesAreFoundBesideTheSceneAndBesideTheIncluder) {
    const SceneFolder folder;
    std::filesystem::create_directory(folder.path("parts"));
    folder.write("parts/light.pbrt", "LightSource \"point\" Include \"geometry.pbrt\"");
    folder.write("parts/geometry.pbrt", "Shape \"sphere\"\n");
    const Scene scene = folder.load(with_world("Include \"parts/light.pbrt\"\nTranslate 1 0 0"));
    EXPECT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.shapes.size(), 1u);
}

} // namespace
} // namespace tristim
