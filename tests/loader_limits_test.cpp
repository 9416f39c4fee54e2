// Inputs that are small but ask for much, or that lead elsewhere: each ends at once with a sentence or is read as it
// should be. Fuzzing (tests/fuzz) looks for others.

#include "scene_folder.h"

#include "base/read_file.h"
#include "base/stopwatch.h"
#include "meshes/mesh_io.h"
#include "meshes/triangulate.h"
#include "scene/scene_parser.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace tristim {
namespace {

using namespace test;

/// Each case took many minutes or did not end before it was mended, and takes a second or two now; the rest is room for
/// sanitizers and a busy machine.
constexpr double at_once_s = 60.0;

void expect_refusal(const std::string& message, const std::string& word) {
    EXPECT_NE(message.find(word), std::string::npos) << message;
}

std::string obj_error(const std::string& text) {
    const SceneFolder folder;
    return error_of([&] { read_mesh(folder.write("m.obj", text), MeshFormat::Obj); });
}

std::string ply_error(const std::string& text) {
    const SceneFolder folder;
    return error_of([&] { read_mesh(folder.write("m.ply", text), MeshFormat::Ply); });
}

std::string scene_error(const std::string& text) {
    const SceneFolder folder;
    return error_of([&] { folder.load(text); });
}

const std::string triangle_obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const std::string triangle_ply = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                                 "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                                 "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

/// The corners of a star with so many points, which is neither convex nor round.
std::vector<Imath::V3f> star(int points) {
    std::vector<Imath::V3f> corners;
    for (int i = 0; i < 2 * points; ++i) {
        const double angle = std::numbers::pi * i / points, radius = i % 2 == 0 ? 1.0 : 0.25;
        corners.emplace_back(static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle)),
                             0.0F);
    }
    return corners;
}

TEST(LoaderLimits, DevicesAreNoFiles) {
    expect_refusal(error_of([] { read_whole_file("/dev/zero"); }), "device");
    expect_refusal(error_of([] { Spectrum::read_spd("/dev/zero"); }), "device");
}

TEST(LoaderLimits, ObjFilesLeadNowhereElse) {
    const SceneFolder folder;
    const Stopwatch stopwatch;
    const std::string text = "mtllib /dev/zero\n" + triangle_obj + "f 1 2 3\n";
    EXPECT_EQ(read_mesh(folder.write("m.obj", text), MeshFormat::Obj).triangles.size(), 1U);
    EXPECT_LT(stopwatch.seconds(), at_once_s);
}

TEST(LoaderLimits, ObjLinesThatOnlyOpenMeshTakesForFacesAreNone) {
    // A vertical tab is no blank here; with it for one, the corner "/1" has no vertex, and the reader looked for one.
    const SceneFolder folder;
    const std::string text = triangle_obj + "vt 0 0\nf\v/1 2 3\nf 1/1 2/1 3/1\n";
    EXPECT_EQ(read_mesh(folder.write("m.obj", text), MeshFormat::Obj).triangles.size(), 1U);
}

TEST(LoaderLimits, ObjNumbersThatFloatRoundsToZeroAreFinite) {
    const SceneFolder folder;
    const MeshFile mesh =
        read_mesh(folder.write("m.obj", "v 0 0 1e-50\nv 1 0 -1e-50\nv 0 1 0\nf 1 2 3\n"), MeshFormat::Obj);
    for (const Imath::V3f& position : mesh.positions)
        EXPECT_EQ(position.z, 0.0F);
    expect_refusal(obj_error("v 0 0 3.5e38\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "m.obj:1: \"3.5e38\"");
}

TEST(LoaderLimits, FacesHaveAMostNumberOfCorners) {
    constexpr int too_many = 10001;
    std::string vertices, face = "f", indices = std::to_string(too_many);
    for (int i = 1; i <= too_many; ++i) {
        vertices += fmt::format("v {} {} 0\n", i, i % 7);
        face += fmt::format(" {}", i);
        indices += fmt::format(" {}", i - 1);
    }
    expect_refusal(obj_error(vertices + face + "\n"), "10001 corners");
    std::string lines;
    for (int i = 0; i < too_many; ++i)
        lines += "0 0 " + std::to_string(i) + "\n";
    expect_refusal(ply_error("ply\nformat ascii 1.0\nelement vertex 10001\nproperty float x\nproperty float y\n"
                             "property float z\nelement face 1\nproperty list int int vertex_indices\nend_header\n" +
                             lines + indices + "\n"),
                   "10001 corners");
}

TEST(LoaderLimits, PolygonsOfThousandsOfCornersAreCutAtOnce) {
    const Stopwatch stopwatch;
    for (const int points : {3, 50, 5000}) {
        const std::vector<Imath::V3f> corners = star(points);
        double area = 0.0;
        const auto triangles = triangulate(corners);
        ASSERT_EQ(triangles.size(), corners.size() - 2);
        for (const auto& [a, b, c] : triangles) {
            const double twice = (Imath::V3d(corners[b]) - Imath::V3d(corners[a]))
                                     .cross(Imath::V3d(corners[c]) - Imath::V3d(corners[a]))
                                     .z;
            EXPECT_GE(twice, 0.0);
            area += 0.5 * twice;
        }
        // Of 2 n triangles between the centre and two neighbours. Float corners lie off by 6e-8 at most.
        const double expected = points * 0.25 * std::sin(std::numbers::pi / points);
        EXPECT_NEAR(area, expected, 1e-5 * expected);
    }
    EXPECT_LT(stopwatch.seconds(), at_once_s);
}

TEST(LoaderLimits, PolygonsThatCrossThemselvesAreCutAtOnce) {
    std::vector<Imath::V3f> corners;
    for (int i = 0; i < 10000; ++i)
        corners.emplace_back(static_cast<float>(i * 7919 % 10007), static_cast<float>(i * 104729 % 10009), 0.0F);
    const Stopwatch stopwatch;
    EXPECT_EQ(triangulate(corners).size(), corners.size() - 2);
    EXPECT_LT(stopwatch.seconds(), at_once_s);
}

TEST(LoaderLimits, PlyHeadersPromiseNoMoreThanTheFileHolds) {
    const Stopwatch stopwatch;
    const std::string head = "ply\nformat ascii 1.0\n";
    expect_refusal(ply_error(head + "element nothing 4294967295\n" + triangle_ply), "\"nothing\"");
    std::string many = triangle_ply;
    many.replace(many.find("vertex 3"), 8, "vertex 4294967295");
    expect_refusal(ply_error(head + many), "4294967295 lines of \"vertex\"");
    many = triangle_ply;
    many.replace(many.find("face 1"), 6, "face 2147483648").append(100, ' ');
    expect_refusal(ply_error("ply\nformat binary_little_endian 1.0\n" + many), "2147483648 lines of \"face\"");
    EXPECT_LT(stopwatch.seconds(), at_once_s);
}

TEST(LoaderLimits, SmallScenesThatAskForMuch) {
    const std::string lit = "LightSource \"infinite\"\n";
    struct {
        std::string text;
        const char* word;
    } const cases[] = {
        {"Sampler \"stratified\" \"integer xsamples\" 65536 \"integer ysamples\" 65536\n", "65536 times 65536"},
        {with_world("LightSource \"point\" \"rgb I\" [ 1e308 1 0 ]"), "too large"},
        {with_world("LightSource \"point\" \"float scale\" 1e38 \"float power\" 1e38"), "single precision"},
        {with_world("Scale 1e30 1e30 1e30 LightSource \"point\" \"point3 from\" [ 1e30 0 0 ]"), "too large"},
        {with_world(lit + "Texture \"a\" \"float\" \"constant\" \"float value\" 1e38\n"
                          "Texture \"b\" \"float\" \"scale\" \"texture tex\" \"a\" \"float scale\" 10"),
         "\"b\" are too large"},
        {"Camera \"perspective\" \"float screenwindow\" [ -3e38 3e38 -1 1 ]\n", "screen window"},
        {"Translate 1e38 0 0 Scale 1e-30 1e-30 1e-30 Camera \"perspective\"\n", "camera"},
        {with_world("LightSource \"point\" \"spectrum I\" [ 380 1e-310 780 1e-310 ]"), "too weak"},
    };
    for (const auto& [text, word] : cases)
        expect_refusal(scene_error(text), word);
}

TEST(LoaderLimits, IncludesEnd) {
    const SceneFolder folder;
    const Stopwatch stopwatch;
    // Every file includes the next one ten times: 10^9 readings of the last.
    for (int i = 0; i < 9; ++i) {
        std::string text;
        for (int times = 0; times < 10; ++times)
            text += "Include \"" + std::to_string(i + 1) + ".pbrt\"\n";
        folder.write(std::to_string(i) + ".pbrt", text);
    }
    folder.write("9.pbrt", "");
    expect_refusal(error_of([&] { folder.load("Include \"0.pbrt\"\n"); }), "100000 includes");
    for (int i = 0; i < 70; ++i)
        folder.write("deep" + std::to_string(i) + ".pbrt", "Include \"deep" + std::to_string(i + 1) + ".pbrt\"\n");
    expect_refusal(error_of([&] { folder.load("Include \"deep0.pbrt\"\n"); }), "64 within each other");
    EXPECT_LT(stopwatch.seconds(), at_once_s);
}

TEST(LoaderLimits, InstancesCountAmongTheTrianglesOfAScene) {
    const SceneFolder folder;
    const std::string path =
        folder.write("scene.pbrt", with_world("LightSource \"point\"\nObjectBegin \"ball\"\nShape \"sphere\"\n"
                                              "ObjectEnd\nObjectInstance \"ball\"\nObjectInstance \"ball\"\n"));
    constexpr std::size_t ball = 20480; // that of the definition counts too: it takes memory
    const auto read = [&](std::size_t most) {
        SceneBuilder builder(path, std::nullopt, most);
        SceneParser(path, builder).run();
        return builder.finish().shapes.size();
    };
    EXPECT_EQ(read(3 * ball), 2U);
    expect_refusal(error_of([&] { read(3 * ball - 1); }), "more than 61439 triangles");
}

TEST(LoaderLimits, LongUnknownNamesAreComparedAtOnce) {
    const Stopwatch stopwatch;
    const std::string name(1'000'000, 'x'), other(1'000'000, 'y');
    expect_refusal(scene_error(with_world("LightSource \"point\" \"spectrum I\" \"" + name + "\"")), "did you mean");
    expect_refusal(scene_error(with_world("Texture \"" + name + "\" \"float\" \"constant\"\n" +
                                          "Texture \"t\" \"float\" \"scale\" \"texture tex\" \"" + other + "\"")),
                   "did you mean");
    EXPECT_LT(stopwatch.seconds(), at_once_s);
}

TEST(LoaderLimits, TexturesHaveAMostNumberOfValues) {
    // The head of a bitmap of 40,000 by 40,000 pixels without any: it can be opened.
    const auto bytes = [](std::uint32_t value, int count) {
        std::string text;
        for (int i = 0; i < count; ++i)
            text += static_cast<char>(value >> (8 * i) & 0xFF);
        return text;
    };
    const SceneFolder folder;
    folder.write("huge.bmp", "BM" + bytes(54, 4) + bytes(0, 4) + bytes(54, 4) + bytes(40, 4) + bytes(40000, 4) +
                                 bytes(40000, 4) + bytes(1, 2) + bytes(24, 2) + bytes(0, 4) + bytes(0, 4) +
                                 bytes(2835, 4) + bytes(2835, 4) + bytes(0, 4) + bytes(0, 4));
    const std::string texture = "Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"huge.bmp\"";
    expect_refusal(error_of([&] { folder.load(with_world(texture)); }), "268435456 values");
}

} // namespace
} // namespace tristim
