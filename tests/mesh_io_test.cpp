#include "mesh_files.h"
#include "scene_folder.h"

#include "meshes/mesh_io.h"
#include "meshes/triangulate.h"

#include <algorithm>
#include <cmath>

namespace tristim {
namespace {

using namespace test;
using Triangle = std::array<std::uint32_t, 3>;

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

} // namespace
} // namespace tristim
