// The texture coordinates of surfaces, as scene files give them.

#include "scene_folder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

namespace tristim {
namespace {

using Imath::V2d;
using std::numbers::pi;
using test::SceneFolder;
using test::with_world;

std::array<float, 3> position_of(const Mesh& mesh, std::uint32_t vertex) {
    const V3f p(mesh.positions[vertex]);
    return {p.x, p.y, p.z};
}

/// The texture coordinates of a shape's corners by their positions.
std::map<std::array<float, 3>, std::vector<V2f>> coordinates(const Mesh& mesh) {
    std::map<std::array<float, 3>, std::vector<V2f>> result;
    for (const auto& corners : mesh.triangles) {
        for (const std::uint32_t i : corners)
            result[position_of(mesh, i)].push_back(mesh.uv.at(i));
    }
    return result;
}

Mesh shape(const std::string& directives) {
    const SceneFolder folder;
    return folder.load(with_world("LightSource \"point\"\n" + directives)).shapes.at(0).mesh;
}

TEST(SceneUv, TriangleMeshesHaveThoseOfTheFile) {
    for (const char* name : {"uv", "st"}) {
        const Mesh mesh = shape(fmt::format("Scale -2 1 1 Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] "
                                            "\"point2 {}\" [0.25 0.5  2 -3  0 7]",
                                            name));
        const auto uv = coordinates(mesh);
        EXPECT_EQ(uv.at({0, 0, 0}).at(0), V2f(0.25F, 0.5F));
        EXPECT_EQ(uv.at({-2, 0, 0}).at(0), V2f(2, -3));
        EXPECT_EQ(uv.at({0, 1, 0}).at(0), V2f(0, 7));
    }
    EXPECT_TRUE(shape("Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]").uv.empty());
}

TEST(SceneUv, InstancesAndLightsOfPatchesKeepThem) {
    const SceneFolder folder;
    const std::string mesh = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0] "
                             "\"integer indices\" [0 1 2 2 1 3] \"point2 uv\" [0 0 3 0 0 4 5 6] ";
    const Scene scene = folder.load(with_world("ObjectBegin \"a\" " + mesh +
                                               "ObjectEnd Translate 1 0 0 ObjectInstance \"a\" "
                                               "AreaLightSource \"diffuse\" \"float power\" 1 " +
                                               mesh));
    ASSERT_EQ(scene.shapes.size(), 3u);
    EXPECT_EQ(coordinates(scene.shapes[0].mesh).at({2, 1, 0}).at(0), V2f(5, 6));
    EXPECT_EQ(coordinates(scene.shapes[1].mesh).at({2, 0, 0}).at(0), V2f(3, 0));
    EXPECT_EQ(coordinates(scene.shapes[2].mesh).at({2, 1, 0}).at(0), V2f(5, 6));
    EXPECT_EQ(scene.shapes[2].mesh.uv.size(), scene.shapes[2].mesh.positions.size());
}

TEST(SceneUv, PatchesHaveTheirOwnByDefault) {
    const auto uv = coordinates(shape("Shape \"bilinearmesh\" \"point3 P\" [0 0 0  2 0 0  0 3 0  2 3 0]"));
    EXPECT_EQ(uv.at({0, 0, 0}).at(0), V2f(0, 0));
    EXPECT_EQ(uv.at({2, 0, 0}).at(0), V2f(1, 0));
    EXPECT_EQ(uv.at({0, 3, 0}).at(0), V2f(0, 1));
    EXPECT_EQ(uv.at({2, 3, 0}).at(0), V2f(1, 1));
    const auto given = coordinates(shape("Shape \"bilinearmesh\" \"point3 P\" [0 0 0  2 0 0  0 3 0  2 3 0] "
                                         "\"point2 uv\" [5 5 6 5 5 6 6 7]"));
    EXPECT_EQ(given.at({2, 3, 0}).at(0), V2f(6, 7));
}

TEST(SceneUv, PatchesThatShareCornersHaveThemApart) {
    // Two patches side by side: the vertices at x = 1 are p10, p11 of the first and p00, p01 of the second.
    const Mesh mesh =
        shape("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 2 0 0  0 1 0 1 1 0 2 1 0] "
              "\"normal N\" [0 0 1 0 0 1 0 0 1 0 0 1 0 0 1 0 0 1] \"integer indices\" [0 1 3 4  1 2 4 5]");
    ASSERT_EQ(mesh.triangles.size(), 4u);
    EXPECT_EQ(mesh.positions.size(), 8u);
    EXPECT_EQ(mesh.normals.size(), 8u);
    for (std::size_t i = 0; i < 4; ++i) {
        for (const std::uint32_t corner : mesh.triangles[i]) {
            const V3f p(mesh.positions[corner]);
            EXPECT_EQ(mesh.uv[corner], V2f(p.x - (i < 2 ? 0.0F : 1.0F), p.y));
        }
    }
}

TEST(SceneUv, SphereHasPbrtsAnglesWithASeam) {
    const Mesh mesh = shape("Shape \"sphere\" \"float radius\" 2");
    ASSERT_EQ(mesh.triangles.size(), 20480u);
    ASSERT_EQ(mesh.uv.size(), mesh.positions.size());
    double covered = 0.0;
    std::size_t poles = 0, seam_0 = 0, seam_1 = 0;
    for (const auto& corners : mesh.triangles) {
        std::array<V2d, 3> uv{};
        for (std::size_t i = 0; i < 3; ++i) {
            const V3d p(mesh.positions[corners[i]]);
            uv[i] = V2d(mesh.uv[corners[i]]);
            EXPECT_GE(uv[i].x, 0.0);
            EXPECT_LE(uv[i].x, 1.0);
            // One rounding to float of the angle, and those of the position as seen from the axis.
            EXPECT_NEAR(uv[i].y, 1.0 - std::acos(std::clamp(p.z / p.length(), -1.0, 1.0)) / pi, 1e-6);
            const double across = std::hypot(p.x, p.y);
            if (across == 0.0) {
                ++poles;
                continue;
            }
            double turn = std::atan2(p.y, p.x) / (2.0 * pi);
            turn += turn < 0.0 ? 1.0 : 0.0;
            if (p.y == 0.0 && p.x > 0.0) {
                seam_0 += uv[i].x == 0.0 ? 1 : 0;
                seam_1 += uv[i].x == 1.0 ? 1 : 0;
                EXPECT_TRUE(uv[i].x == 0.0 || uv[i].x == 1.0);
            } else {
                EXPECT_NEAR(uv[i].x, turn, 1e-6 / across);
            }
        }
        const V2d a = uv[1] - uv[0], b = uv[2] - uv[0];
        const double twice = a.x * b.y - a.y * b.x;
        EXPECT_GT(twice, 0.0) << "a triangle is folded over";
        const auto pole = std::find_if(uv.begin(), uv.end(), [](const V2d& c) { return c.y == 0.0 || c.y == 1.0; });
        if (pole == uv.end()) {
            covered += 0.5 * twice;
            continue;
        }
        // A pole is a whole side of the unit square; its triangles stand for the strips between their other corners and
        // it.
        std::rotate(uv.begin(), pole, uv.end());
        EXPECT_NEAR(uv[0].x, 0.5 * (uv[1].x + uv[2].x), 1e-7);
        covered += std::abs(uv[1].x - uv[2].x) * std::abs(0.5 * (uv[1].y + uv[2].y) - uv[0].y);
    }
    EXPECT_EQ(poles, 12u); // six triangles at each
    EXPECT_EQ(seam_0, seam_1);
    EXPECT_GT(seam_0, 0u);
    // Every triangle's corners are rounded to half a unit of roundoff.
    EXPECT_NEAR(covered, 1.0, 1e-6);
}

} // namespace
} // namespace tristim
