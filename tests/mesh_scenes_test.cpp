#include "scene_folder.h"

#include "scene/geometry.h"

#include <cmath>
#include <map>
#include <optional>

/// The scenes in meshes/, and whether they are built as their comments say.

namespace tristim {
namespace {

Scene shipped(const std::string& name) {
    return load_scene(std::string(TRISTIM_SOURCE_DIR) + "/meshes/" + name + "/scene.pbrt");
}

const Shape& shape_of(const Scene& scene, Material::Kind kind) {
    for (const Shape& shape : scene.shapes) {
        if (scene.materials.at(static_cast<std::size_t>(shape.material)).kind == kind)
            return shape;
    }
    throw std::runtime_error("no such shape");
}

/// Volume by the divergence theorem: positive if the mesh is closed and faces outward.
double volume(const Mesh& mesh) {
    double sum = 0.0;
    for (const auto& [a, b, c] : mesh.triangles)
        sum += V3d(mesh.positions[a]).dot(V3d(mesh.positions[b]).cross(V3d(mesh.positions[c]))) / 6.0;
    return sum;
}

/// Every directed edge must meet its opposite exactly once.
bool is_closed(const Mesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const auto& triangle : mesh.triangles) {
        for (std::size_t i = 0; i < 3; ++i)
            ++edges[{triangle[i], triangle[(i + 1) % 3]}];
    }
    for (const auto& [edge, count] : edges) {
        const auto opposite = edges.find({edge.second, edge.first});
        if (count != 1 || opposite == edges.end())
            return false;
    }
    return true;
}

TEST(MeshScene, DispersionIsAClosedIcosahedronAboveTheFloor) {
    const Scene scene = shipped("dispersion");
    const Mesh& mesh = shape_of(scene, Material::Kind::Dielectric).mesh;
    EXPECT_EQ(mesh.positions.size(), 12u);
    EXPECT_EQ(mesh.triangles.size(), 20u);
    EXPECT_TRUE(is_closed(mesh));
    // An icosahedron of circumradius R has the edge R / sin(2π/5) and the volume 5 (3 + √5) / 12 edge³.
    const double edge = 1.1 / std::sin(2.0 * M_PI / 5.0);
    EXPECT_NEAR(volume(mesh), 5.0 * (3.0 + std::sqrt(5.0)) / 12.0 * edge * edge * edge, 1e-5);
    for (const V3d& position : mesh.positions)
        EXPECT_GE(position.z, 0.04f - 1e-6f);
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.lights[0].kind, Light::Kind::Spot);
}

TEST(MeshScene, BoxIsDiffuseWithOneLightThatShinesDown) {
    const Scene scene = shipped("box");
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.lights[0].kind, Light::Kind::Area);
    for (const Material& material : scene.materials)
        EXPECT_EQ(material.kind, Material::Kind::Diffuse);
    for (const Shape& shape : scene.shapes) {
        const auto& [a, b, c] = shape.mesh.triangles.at(0);
        const V3d v0(shape.mesh.positions[a]), v1(shape.mesh.positions[b]), v2(shape.mesh.positions[c]);
        const V3d normal = (v1 - v0).cross(v2 - v0).normalized();
        if (shape.area_light >= 0)
            EXPECT_NEAR(normal.z, -1.0, 1e-6);
        else if (shape.mesh.triangles.size() == 12)
            EXPECT_TRUE(is_closed(shape.mesh) && volume(shape.mesh) > 0.0);
        else // walls look at the middle of the box
            EXPECT_GT(normal.dot(V3d(0, 0, 1) - v0), 0.0);
    }
}

struct Hit {
    double t = 0.0;
    const Shape* shape = nullptr;
    V3d normal{0.0}; ///< unit, geometric
};

/// Brute force in double precision (Möller & Trumbore 1997).
std::optional<Hit> intersect(const Scene& scene, const V3d& origin, const V3d& direction) {
    std::optional<Hit> nearest;
    for (const Shape& shape : scene.shapes) {
        for (const auto& [a, b, c] : shape.mesh.triangles) {
            const V3d v0(shape.mesh.positions[a]);
            const V3d e1 = V3d(shape.mesh.positions[b]) - v0, e2 = V3d(shape.mesh.positions[c]) - v0;
            const V3d p = direction.cross(e2);
            const double determinant = e1.dot(p);
            if (determinant == 0.0)
                continue;
            const V3d s = origin - v0, q = s.cross(e1);
            const double u = s.dot(p) / determinant, v = direction.dot(q) / determinant;
            const double t = e2.dot(q) / determinant;
            if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 1e-6 && (!nearest || t < nearest->t))
                nearest = Hit{t, &shape, e1.cross(e2).normalized()};
        }
    }
    return nearest;
}

/// Snell's law; empty at total internal reflection. `eta` is the index inside over outside, `normal` points outside.
std::optional<V3d> refract(const V3d& direction, V3d normal, double eta) {
    double cosine = -direction.dot(normal);
    double ratio = 1.0 / eta;
    if (cosine < 0.0) {
        cosine = -cosine;
        normal = -normal;
        ratio = eta;
    }
    const double cos2 = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
    if (cos2 < 0.0)
        return std::nullopt;
    return direction * ratio + normal * (ratio * cosine - std::sqrt(cos2));
}

/// Where the light of one wavelength that passes the middle of the slit ends, and after how many refractions.
std::pair<V3d, int> follow_beam(const Scene& scene, double nm) {
    V3d position = scene.lights.at(0).position, direction = scene.lights.at(0).direction;
    for (int refractions = 0; refractions < 8; ++refractions) {
        const std::optional<Hit> hit = intersect(scene, position, direction);
        if (!hit)
            throw std::runtime_error("the beam leaves the scene");
        position += direction * hit->t;
        const Material& material = scene.materials.at(static_cast<std::size_t>(hit->shape->material));
        if (material.kind == Material::Kind::Diffuse)
            return {position, refractions};
        direction = refract(direction, hit->normal, material.eta(nm)).value();
    }
    throw std::runtime_error("the beam does not end");
}

TEST(MeshScene, PrismSpreadsTheVisibleSpectrumOverTheScreen) {
    const Scene scene = shipped("prism");
    const Mesh& prism = shape_of(scene, Material::Kind::Dielectric).mesh;
    EXPECT_TRUE(is_closed(prism));
    // An equilateral triangle of side 1.2, 1.2 high.
    EXPECT_NEAR(volume(prism), 1.2 * 1.2 * std::sqrt(3.0) / 4.0 * 1.2, 1e-6);

    // The ray of 540 nm is turned symmetrically, so it meets the middle of the screen.
    const V3d centre(3.2115276, -1.4228077, 0.6);
    const auto [green, refractions] = follow_beam(scene, 540.0);
    EXPECT_EQ(refractions, 2);
    EXPECT_NEAR((green - centre).length(), 0.0, 1e-3);

    const V3d across = V3d(0.554978, 0.831865, 0.0); // along the screen
    double previous = -1.0;
    for (const double nm : {380.0, 400.0, 450.0, 500.0, 550.0, 600.0, 650.0, 700.0, 780.0}) {
        const auto [end, count] = follow_beam(scene, nm);
        const double along = (end - centre).dot(across);
        EXPECT_EQ(count, 2) << nm;
        EXPECT_GT(along, previous) << nm;                                       // in order
        EXPECT_NEAR((end - centre - across * along).length(), 0.0, 1e-3) << nm; // on the screen's line
        EXPECT_LT(std::abs(along), 1.3) << nm;                                  // inside it
        previous = along;
    }
    // The slit's image is 0.03 · 7.7 / 3 = 0.08 wide; the spectrum from 400 to 700 nm is several times as wide.
    EXPECT_GT((follow_beam(scene, 700.0).first - follow_beam(scene, 400.0).first).length(), 5 * 0.08);
}

} // namespace
} // namespace tristim
