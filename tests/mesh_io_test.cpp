#include "scene_folder.h"

#include "meshes/mesh_io.h"
#include "meshes/triangulate.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace tristim {
namespace {

using test::error_of;
using test::SceneFolder;
using Triangle = std::array<std::uint32_t, 3>;

struct TestMesh {
    std::vector<V3f> positions;
    std::vector<V3f> normals;
    std::vector<std::vector<int>> faces;
};

/// A pyramid over a square: one quadrilateral and four triangles, coordinates that need all digits of a float.
TestMesh pyramid(bool with_normals) {
    TestMesh mesh;
    const float a = 1.0f / 3.0f;
    mesh.positions = {{a, a, 0}, {-a, a, 0}, {-a, -a, 0}, {a, -a, 0}, {0, 0, 0.7654321f}};
    if (with_normals) {
        for (const V3f& position : mesh.positions)
            mesh.normals.push_back((position - V3f(0, 0, 0.2f)).normalized());
    }
    mesh.faces = {{3, 2, 1, 0}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
    return mesh;
}

std::string ply_header(const TestMesh& mesh, const std::string& form) {
    std::string header = fmt::format("ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
                                     "property float z\n",
                                     form, mesh.positions.size());
    if (!mesh.normals.empty())
        header += "property float nx\nproperty float ny\nproperty float nz\n";
    return header +
           fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n", mesh.faces.size());
}

std::string ascii_ply(const TestMesh& mesh) {
    std::string text = ply_header(mesh, "ascii");
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const V3f& p = mesh.positions[i];
        text += fmt::format("{} {} {}", p.x, p.y, p.z);
        if (!mesh.normals.empty())
            text += fmt::format(" {} {} {}", mesh.normals[i].x, mesh.normals[i].y, mesh.normals[i].z);
        text += "\n";
    }
    for (const auto& face : mesh.faces)
        text += fmt::format("{} {}\n", face.size(), fmt::join(face, " "));
    return text;
}

template <typename T>
void append(std::string& bytes, T value, bool big_endian) {
    std::array<char, sizeof(T)> raw{};
    std::memcpy(raw.data(), &value, sizeof(T));
    if (big_endian == (std::endian::native == std::endian::little))
        std::reverse(raw.begin(), raw.end());
    for (const char byte : raw)
        bytes.push_back(byte);
}

std::string binary_ply(const TestMesh& mesh, bool big_endian) {
    std::string bytes = ply_header(mesh, big_endian ? "binary_big_endian" : "binary_little_endian");
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        for (int axis = 0; axis < 3; ++axis)
            append(bytes, mesh.positions[i][axis], big_endian);
        for (int axis = 0; axis < 3 && !mesh.normals.empty(); ++axis)
            append(bytes, mesh.normals[i][axis], big_endian);
    }
    for (const auto& face : mesh.faces) {
        append(bytes, static_cast<unsigned char>(face.size()), big_endian);
        for (const int vertex : face)
            append(bytes, vertex, big_endian);
    }
    return bytes;
}

std::string obj(const TestMesh& mesh) {
    std::string text = "# a pyramid\no pyramid\n";
    for (const V3f& p : mesh.positions)
        text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
    for (const V3f& n : mesh.normals)
        text += fmt::format("vn {} {} {}\n", n.x, n.y, n.z);
    for (const auto& face : mesh.faces) {
        text += "f";
        for (const int vertex : face)
            text += mesh.normals.empty() ? fmt::format(" {}", vertex + 1) : fmt::format(" {0}//{0}", vertex + 1);
        text += "\n";
    }
    return text;
}

/// Every triangle as its three positions, turned so that the smallest comes first; and their normals beside them.
std::vector<std::array<std::array<float, 6>, 3>> corner_lists(const MeshFile& mesh) {
    std::vector<std::array<std::array<float, 6>, 3>> result;
    for (const Triangle& triangle : mesh.triangles) {
        std::array<std::array<float, 6>, 3> corners{};
        for (std::size_t i = 0; i < 3; ++i) {
            const V3f& p = mesh.positions[triangle[i]];
            const V3f n = mesh.normals.empty() ? V3f(0.0f) : mesh.normals[triangle[i]];
            corners[i] = {p.x, p.y, p.z, n.x, n.y, n.z};
        }
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
        result.push_back(corners);
    }
    std::sort(result.begin(), result.end());
    return result;
}

void expect_pyramid(const MeshFile& file, const TestMesh& mesh) {
    ASSERT_EQ(file.triangles.size(), 6u);
    EXPECT_EQ(file.positions.size(), 5u);
    EXPECT_EQ(file.normals.size(), mesh.normals.size());
    EXPECT_EQ(file.degenerate_faces, 0);
    MeshFile expected;
    expected.positions = mesh.positions;
    expected.normals = mesh.normals;
    expected.triangles = {{2, 1, 0}, {3, 2, 0}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
    MeshFile other_diagonal = expected;
    other_diagonal.triangles[0] = {3, 2, 1};
    other_diagonal.triangles[1] = {3, 1, 0};
    // Floats survive text and binary to the last bit; either diagonal of the square will do.
    EXPECT_TRUE(corner_lists(file) == corner_lists(expected) || corner_lists(file) == corner_lists(other_diagonal));
    EXPECT_EQ(std::count(file.faces.begin(), file.faces.end(), 0u), 2);
}

TEST(MeshIo, EveryFormatGivesTheSameMesh) {
    const SceneFolder folder;
    for (const bool with_normals : {false, true}) {
        const TestMesh mesh = pyramid(with_normals);
        SCOPED_TRACE(with_normals);
        expect_pyramid(read_mesh(folder.write("a.ply", ascii_ply(mesh)), MeshFormat::Ply), mesh);
        expect_pyramid(read_mesh(folder.write("l.ply", binary_ply(mesh, false)), MeshFormat::Ply), mesh);
        expect_pyramid(read_mesh(folder.write("b.ply", binary_ply(mesh, true)), MeshFormat::Ply), mesh);
        expect_pyramid(read_mesh(folder.write("m.obj", obj(mesh)), MeshFormat::Obj), mesh);
    }
}

TEST(MeshIo, PlyPropertiesThatAreNotNeededAreSkipped) {
    const SceneFolder folder;
    std::string bytes = "ply\r\nformat binary_big_endian 1.0\r\ncomment x\r\nelement camera 2\r\nproperty short a\r\n"
                        "element vertex 3\r\nproperty double red\r\nproperty double x\r\nproperty uchar u\r\n"
                        "property float y\r\nproperty float z\r\nelement face 1\r\n"
                        "property list int ushort vertex_index\r\nproperty uchar flags\r\nelement edge 1\r\n"
                        "property int v\r\nend_header\r\n";
    append(bytes, std::int16_t{7}, true);
    append(bytes, std::int16_t{8}, true);
    for (int i = 0; i < 3; ++i) {
        append(bytes, 0.5, true);
        append(bytes, i + 0.25, true);
        append(bytes, static_cast<unsigned char>(9), true);
        append(bytes, static_cast<float>(i * i), true);
        append(bytes, -1.0f, true);
    }
    append(bytes, 3, true);
    for (const std::uint16_t vertex : std::array<std::uint16_t, 3>{2, 0, 1})
        append(bytes, vertex, true);
    append(bytes, static_cast<unsigned char>(1), true);
    append(bytes, 42, true);
    const MeshFile mesh = read_mesh(folder.write("m.ply", bytes), MeshFormat::Ply);
    ASSERT_EQ(mesh.triangles.size(), 1u);
    EXPECT_EQ(mesh.positions[mesh.triangles[0][0]], V3f(2.25f, 4, -1));
    EXPECT_EQ(mesh.positions[mesh.triangles[0][1]], V3f(0.25f, 0, -1));
    EXPECT_EQ(mesh.positions[mesh.triangles[0][2]], V3f(1.25f, 1, -1));
}

TEST(MeshIo, ObjTakesNegativeIndicesTextureCoordinatesAndMaterials) {
    const SceneFolder folder;
    const MeshFile mesh =
        read_mesh(folder.write("m.obj", "mtllib absent.mtl\r\nv 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nvt 0 0\r\n"
                                        "usemtl none\r\ns off\r\nf -3/1 -2/1 -1/1 \r\n"),
                  MeshFormat::Obj);
    ASSERT_EQ(mesh.triangles.size(), 1u);
    EXPECT_EQ(mesh.positions[mesh.triangles[0][1]], V3f(1, 0, 0));
    EXPECT_TRUE(mesh.normals.empty());
}

TEST(MeshIo, ObjVerticesSplitWhereNormalsDiffer) {
    const SceneFolder folder;
    // Two faces of a roof that share an edge, each with its own flat normal.
    const MeshFile mesh = read_mesh(folder.write("m.obj", "v 0 0 0\nv 0 1 0\nv 1 0 -1\nv -1 0 -1\nvn 1 0 1\nvn -1 0 1\n"
                                                          "f 1//1 3//1 2//1\nf 1//2 2//2 4//2\n"),
                                    MeshFormat::Obj);
    ASSERT_EQ(mesh.positions.size(), 6u);
    for (std::size_t face = 0; face < 2; ++face) {
        for (const std::uint32_t vertex : mesh.triangles[face])
            EXPECT_EQ(mesh.normals[vertex], V3f(face == 0 ? 1.0f : -1.0f, 0, 1));
    }
}

TEST(MeshIo, ObjVerticesSplitWhereTextureCoordinatesDiffer) {
    const SceneFolder folder;
    // Two triangles of a square: the vertex 1 has different coordinates in them, the vertex 3 the same, with a w or
    // without.
    const MeshFile mesh = read_mesh(folder.write("m.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0.25 0.5\nvt 1 0 9\n"
                                                          "vt 1 1\nvt -2 3\nvn 0 0 1\n"
                                                          "f 1/1/1 2/2/1 3/3/1\nf 1/4/1 3/3/1 4/2/1\n"),
                                    MeshFormat::Obj);
    ASSERT_EQ(mesh.positions.size(), 5u);
    ASSERT_EQ(mesh.uv.size(), 5u);
    ASSERT_EQ(mesh.normals.size(), 5u);
    const std::array<std::array<V2f, 3>, 2> expected{
        {{V2f(0.25F, 0.5F), V2f(1, 0), V2f(1, 1)}, {V2f(-2, 3), V2f(1, 1), V2f(1, 0)}}};
    for (std::size_t i = 0; i < 2; ++i) {
        for (std::size_t corner = 0; corner < 3; ++corner)
            EXPECT_EQ(mesh.uv[mesh.triangles[i][corner]], expected[i][corner]);
    }
}

TEST(MeshIo, ObjTextureCoordinatesMayStandAnywhereAndBeCountedBackwards) {
    const SceneFolder folder;
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\n", uv = "vt 1 2\nvt 3 4\nvt 5 6\n";
    for (const std::string& text :
         {vertices + uv + "f 1/-3 2/-2 3/-1\n", uv + "f 1/1 2/2 3/3\n" + vertices, vertices + "f 1/1 2/2 3/3\n" + uv}) {
        const MeshFile mesh = read_mesh(folder.write("m.obj", text), MeshFormat::Obj);
        ASSERT_EQ(mesh.uv.size(), 3u) << text;
        for (std::size_t i = 0; i < 3; ++i)
            EXPECT_EQ(mesh.uv[mesh.triangles[0][i]],
                      V2f(1.0F + 2.0F * static_cast<float>(i), 2.0F + 2.0F * static_cast<float>(i)))
                << text;
    }
}

TEST(MeshIo, ObjCornersWithoutTextureCoordinatesGetZeros) {
    const SceneFolder folder;
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 5 6\n";
    const MeshFile mesh = read_mesh(folder.write("m.obj", vertices + "f 1/1 2/1 3/1\nf 1 3 4\n"), MeshFormat::Obj);
    ASSERT_EQ(mesh.uv.size(), 6u);
    for (std::size_t corner = 0; corner < 3; ++corner) {
        EXPECT_EQ(mesh.uv[mesh.triangles[0][corner]], V2f(5, 6));
        EXPECT_EQ(mesh.uv[mesh.triangles[1][corner]], V2f(0, 0));
    }
    EXPECT_TRUE(read_mesh(folder.write("m.obj", vertices + "f 1 2 3\n"), MeshFormat::Obj).uv.empty());
}

TEST(MeshIo, PlyTextureCoordinatesUnderAllTheirNames) {
    const SceneFolder folder;
    const std::vector<std::array<const char*, 2>> names{
        {"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}};
    for (const auto& [u, v] : names) {
        for (const char* type : {"float", "double"}) {
            const std::string text = fmt::format(
                "ply\nformat ascii 1.0\nelement vertex 3\nproperty {2} {0}\nproperty float x\nproperty float y\n"
                "property {2} {1}\nproperty float z\nelement face 1\nproperty list uchar int "
                "vertex_indices\nend_header\n"
                "0.25 0 0 0.5 1\n-2 1 0 3 1\n7 0 1 8 1\n3 0 1 2\n",
                u, v, type);
            const MeshFile mesh = read_mesh(folder.write("m.ply", text), MeshFormat::Ply);
            ASSERT_EQ(mesh.uv.size(), 3u) << u << " " << type;
            EXPECT_EQ(mesh.uv[mesh.triangles[0][0]], V2f(0.25F, 0.5F)) << u << " " << type;
            EXPECT_EQ(mesh.uv[mesh.triangles[0][1]], V2f(-2, 3)) << u << " " << type;
            EXPECT_EQ(mesh.uv[mesh.triangles[0][2]], V2f(7, 8)) << u << " " << type;
            EXPECT_EQ(mesh.positions[mesh.triangles[0][1]], V3f(1, 0, 1)) << u << " " << type;
        }
    }
}

template <typename Uv>
std::string binary_ply_with_uv(const char* type, bool big_endian) {
    std::string bytes =
        fmt::format("ply\nformat binary_{0}_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                    "property float z\nproperty {1} u\nproperty {1} v\nelement face 1\n"
                    "property list uchar int vertex_indices\nend_header\n",
                    big_endian ? "big" : "little", type);
    for (int i = 0; i < 3; ++i) {
        for (const float x : {i == 1 ? 1.0F : 0.0F, i == 2 ? 1.0F : 0.0F, 2.0F})
            append(bytes, x, big_endian);
        append(bytes, static_cast<Uv>(0.5 * i), big_endian);
        append(bytes, static_cast<Uv>(3 - i), big_endian);
    }
    append(bytes, static_cast<unsigned char>(3), big_endian);
    for (const int vertex : {0, 1, 2})
        append(bytes, vertex, big_endian);
    return bytes;
}

TEST(MeshIo, BinaryPlyTextureCoordinates) {
    const SceneFolder folder;
    for (const bool big_endian : {false, true}) {
        for (const std::string& bytes :
             {binary_ply_with_uv<float>("float", big_endian), binary_ply_with_uv<double>("float64", big_endian)}) {
            const MeshFile mesh = read_mesh(folder.write("m.ply", bytes), MeshFormat::Ply);
            ASSERT_EQ(mesh.uv.size(), 3u);
            for (std::size_t i = 0; i < 3; ++i)
                EXPECT_EQ(mesh.uv[mesh.triangles[0][i]],
                          V2f(0.5F * static_cast<float>(i), 3.0F - static_cast<float>(i)));
        }
    }
}

TEST(MeshIo, OneTextureCoordinateAloneIsNone) {
    const SceneFolder folder;
    const MeshFile mesh = read_mesh(
        folder.write("m.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
                              "float z\nproperty float u\nproperty float t\nelement face 1\nproperty list uchar int "
                              "vertex_indices\nend_header\n0 0 0 1 1\n1 0 0 1 1\n0 1 0 1 1\n3 0 1 2\n"),
        MeshFormat::Ply);
    EXPECT_TRUE(mesh.uv.empty());
    EXPECT_EQ(mesh.positions[mesh.triangles[0][2]], V3f(0, 1, 0));
}

TEST(MeshIo, FacesWithRepeatedVerticesAreDroppedAndCounted) {
    const SceneFolder folder;
    TestMesh mesh = pyramid(false);
    mesh.faces.push_back({0, 1, 1});
    mesh.faces.push_back({2, 2, 2});
    EXPECT_EQ(read_mesh(folder.write("m.ply", ascii_ply(mesh)), MeshFormat::Ply).degenerate_faces, 2);
    EXPECT_EQ(read_mesh(folder.write("m.obj", obj(mesh)), MeshFormat::Obj).degenerate_faces, 2);
    const Scene scene =
        folder.load(test::with_world("LightSource \"point\"\nShape \"plymesh\" \"string filename\" \"m.ply\""));
    EXPECT_EQ(scene.shapes.at(0).mesh.triangles.size(), 6u);
    ASSERT_EQ(scene.notes.size(), 1u);
    EXPECT_EQ(scene.notes[0], folder.path("scene.pbrt") + ":4: dropped 2 degenerate faces of \"m.ply\"");
}

TEST(MeshIo, ConcavePolygonsKeepTheirAreaAndOrientation) {
    // A star with ten corners: a fan from one corner would leave it.
    std::vector<V3f> star;
    for (int i = 0; i < 10; ++i) {
        const double angle = i * M_PI / 5.0, r = i % 2 == 0 ? 1.0 : 0.3;
        star.emplace_back(static_cast<float>(r * std::cos(angle)), static_cast<float>(r * std::sin(angle)), 0.5f);
    }
    double sum = 0.0;
    for (const auto& [a, b, c] : triangulate(star)) {
        const float twice = (star[b] - star[a]).cross(star[c] - star[a]).z;
        EXPECT_GT(twice, 0.0f);
        sum += 0.5 * static_cast<double>(twice);
    }
    // Ten triangles from the centre, with sides 1 and 0.3 and the angle π/5.
    EXPECT_NEAR(sum, 10 * 0.5 * 1.0 * 0.3 * std::sin(M_PI / 5.0), 1e-6);
}

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
