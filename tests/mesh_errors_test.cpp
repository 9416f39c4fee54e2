#include "mesh_files.h"
#include "scene_folder.h"

#include "meshes/mesh_io.h"

#include <cstring>
#include <limits>

namespace tristim {
namespace {

using namespace test;

void expect_error(const std::string& path, MeshFormat format, const std::string& word) {
    testing::internal::CaptureStderr();
    const std::string message = error_of([&] { read_mesh(path, format); });
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_NE(message.find(path), std::string::npos) << message;
    EXPECT_NE(message.find(word), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

TEST(MeshError, MissingEmptyAndForeignFiles) {
    const SceneFolder folder;
    for (const MeshFormat format : {MeshFormat::Ply, MeshFormat::Obj}) {
        expect_error(folder.path("absent"), format, "cannot open");
        expect_error(folder.path(""), format, "folder");
    }
    expect_error(folder.write("a.ply", ""), MeshFormat::Ply, "not a PLY file");
    expect_error(folder.write("b.ply", "ply\nformat ascii 1.0\n"), MeshFormat::Ply, "end_header");
    expect_error(folder.write("c.ply", "ply\nformat morse 1.0\nelement vertex 0\nend_header\n"), MeshFormat::Ply,
                 "c.ply:2: ");
    expect_error(folder.write("d.ply", ply_header({}, "ascii")), MeshFormat::Ply, "empty");
    expect_error(folder.write("a.obj", ""), MeshFormat::Obj, "empty");
    expect_error(folder.write("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), MeshFormat::Obj, "empty");
    expect_error(folder.write("c.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 1 2\n"), MeshFormat::Obj, "empty");
}

TEST(MeshError, MalformedPlyHeaders) {
    const SceneFolder folder;
    const std::string whole = ascii_ply(pyramid(true));
    struct {
        const char* from;
        const char* to;
        const char* word;
    } const changes[] = {
        {"ply\n", "plx\n", "not a PLY file"},
        {"format ascii 1.0\n", "", "needs a format"},
        {"element vertex 5\n", "", ":3: this property"},
        {"element vertex 5", "element vertex five", ":3: this element"},
        {"element vertex 5", "element vertex -5", ":3: this element"},
        {"element face 5", "element vertex 5", ":10: this element"},
        {"property float x", "property int x", ":4: the property \"x\""},
        {"property float x\n", "", "lack \"x\""},
        {"property float y", "property float x", ":5: the property \"x\" is given twice"},
        {"property float nx\n", "", "not all"},
        {"property float nx", "property quaternion nx", ":7: this property"},
        {"list uchar int", "list double int", ":11: the types"},
        {"list uchar int", "list uchar float", ":11: the types"},
        {"vertex_indices", "neighbours", ":11: a list"},
        {"property list uchar int vertex_indices\n", "", "lack \"vertex_indices\""},
        {"property list", "property int flags\nproperty list", ":12: \"vertex_indices\""},
        {"element face", "banana\nelement face", ":10: unknown keyword \"banana\""},
    };
    for (const auto& change : changes) {
        std::string text = whole;
        text.replace(text.find(change.from), std::strlen(change.from), change.to);
        expect_error(folder.write("m.ply", text), MeshFormat::Ply, change.word);
    }
}

TEST(MeshError, EveryTruncationOfAPlyFile) {
    const SceneFolder folder;
    for (const std::string& whole : {binary_ply(pyramid(true), false), binary_ply(pyramid(false), true)}) {
        const std::size_t header = whole.find("end_header\n") + 11;
        for (std::size_t size = header; size < whole.size(); ++size)
            expect_error(folder.write("m.ply", whole.substr(0, size)), MeshFormat::Ply, "cut short");
    }
    // Of a text file, the last digit may go without a trace; whole lines may not.
    const std::string text = ascii_ply(pyramid(false));
    for (std::size_t end = text.rfind('\n', text.size() - 2); end > text.find("end_header") + 11;
         end = text.rfind('\n', end - 1))
        expect_error(folder.write("m.ply", text.substr(0, end)), MeshFormat::Ply, "cut short");
}

TEST(MeshError, NonFiniteVertices) {
    const SceneFolder folder;
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        TestMesh mesh = pyramid(false);
        mesh.positions[3].y = bad;
        expect_error(folder.write("b.ply", binary_ply(mesh, false)), MeshFormat::Ply, "vertex 3");
        expect_error(folder.write("a.ply", ascii_ply(mesh)), MeshFormat::Ply, "malformed");
        expect_error(folder.write("m.obj", obj(mesh)), MeshFormat::Obj, "m.obj:6: ");
    }
    expect_error(folder.write("m.obj", "v 0 0 1e99\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), MeshFormat::Obj,
                 "m.obj:1: \"1e99\"");
    TestMesh mesh = pyramid(true);
    mesh.normals[2].x = std::numeric_limits<float>::quiet_NaN();
    expect_error(folder.write("n.ply", binary_ply(mesh, false)), MeshFormat::Ply, "normal of vertex 2");
}

TEST(MeshError, IndicesOutOfRange) {
    const SceneFolder folder;
    for (const int bad : {5, 1000000, -1}) {
        TestMesh mesh = pyramid(false);
        mesh.faces[2][1] = bad;
        expect_error(folder.write("a.ply", ascii_ply(mesh)), MeshFormat::Ply, "out of range");
        expect_error(folder.write("b.ply", binary_ply(mesh, false)), MeshFormat::Ply, "out of range");
    }
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    expect_error(folder.write("m.obj", vertices + "f 1 2 4\n"), MeshFormat::Obj, "m.obj:4: the vertex index 4");
    expect_error(folder.write("m.obj", vertices + "f 1 2 0\n"), MeshFormat::Obj, "m.obj:4: the vertex index 0");
    expect_error(folder.write("m.obj", vertices + "f 1 2 -4\n"), MeshFormat::Obj, "m.obj:4: the vertex index -4");
    expect_error(folder.write("m.obj", vertices + "f 1//1 2//1 3//1\n"), MeshFormat::Obj,
                 "m.obj:4: the normal index 1");
    expect_error(folder.write("m.obj", vertices + "f 1 2 x\n"), MeshFormat::Obj, "m.obj:4: \"x\"");
    expect_error(folder.write("m.obj", vertices + "f 1 2\n"), MeshFormat::Obj, "m.obj:4: a face has 2 corners");
    expect_error(folder.write("m.obj", "v 0 0\n"), MeshFormat::Obj, "m.obj:1: ");
}

TEST(MeshError, BadTextureCoordinates) {
    const SceneFolder folder;
    const std::string obj_head = "v 0 0 0\nv 1 0 0\nv 0 1 0\n", face = "\nf 1/1 2/1 3/1\n";
    expect_error(folder.write("m.obj", obj_head + "vt 0.5" + face), MeshFormat::Obj, "m.obj:4: ");
    expect_error(folder.write("m.obj", obj_head + "vt 0.5 nan" + face), MeshFormat::Obj, "m.obj:4: \"nan\"");
    expect_error(folder.write("m.obj", obj_head + "vt 0.5 x" + face), MeshFormat::Obj, "m.obj:4: \"x\"");
    expect_error(folder.write("m.obj", obj_head + "vt 0 0\nf 1/1 2/2 3/1\n"), MeshFormat::Obj,
                 "m.obj:5: the texture coordinate index 2");
    const std::string ply_head =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
        "float z\n";
    const std::string ply_rest = "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                                 "0 0 0 1 1\n1 0 0 1 1\n0 1 0 1 1\n3 0 1 2\n";
    expect_error(folder.write("m.ply", ply_head + "property uchar u\nproperty float v\n" + ply_rest), MeshFormat::Ply,
                 "the property \"u\"");
    std::string binary = binary_ply_with_uv<float>("float", false);
    const float bad = std::numeric_limits<float>::infinity();
    std::memcpy(&binary[binary.find("end_header\n") + 11 + 20 + 12], &bad, sizeof(bad));
    expect_error(folder.write("m.ply", binary), MeshFormat::Ply, "texture coordinates of vertex 1");
}

TEST(MeshError, NonManifoldMeshesNameTheEdgeOrVertex) {
    const SceneFolder folder;
    TestMesh fin = pyramid(false);
    fin.positions.emplace_back(0.0f, 0.0f, -1.0f);
    fin.faces.push_back({0, 4, 5});
    expect_error(folder.write("fin.ply", ascii_ply(fin)), MeshFormat::Ply,
                 "3 faces share the edge between the vertices 0 and 4");
    expect_error(folder.write("fin.obj", obj(fin)), MeshFormat::Obj,
                 "3 faces share the edge between the vertices 1 and 5");

    TestMesh flipped = pyramid(false);
    flipped.faces[0] = {0, 1, 2, 3};
    expect_error(folder.write("flipped.ply", ascii_ply(flipped)), MeshFormat::Ply,
                 "two faces run through the edge between the vertices 0 and 1 in the same direction");

    TestMesh hourglass;
    hourglass.positions = {{0, 0, 0}, {1, 0, 1}, {0, 1, 1}, {1, 0, -1}, {0, 1, -1}};
    hourglass.faces = {{0, 1, 2}, {0, 3, 4}};
    expect_error(folder.write("hourglass.ply", ascii_ply(hourglass)), MeshFormat::Ply, "the faces at the vertex 0");
}

TEST(MeshError, SceneErrorsNameSceneAndMesh) {
    const SceneFolder folder;
    folder.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 9\n");
    const std::string message = error_of([&] {
        folder.load(test::with_world("LightSource \"point\"\nShape \"objmesh\" \"string filename\" \"m.obj\""));
    });
    EXPECT_EQ(message.rfind(folder.path("scene.pbrt") + ":4: " + folder.path("m.obj") + ":5: ", 0), 0u) << message;
}

} // namespace
} // namespace tristim
