#include "scene/shapes.h"

#include "meshes/icosphere.h"
#include "meshes/mesh_io.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tristim {

namespace {

/// Subdivisions of the icosahedron that stands for a sphere: 20,480 triangles, vertices on the sphere, centres of
/// triangles 2e-4 radii below it.
constexpr int sphere_subdivisions = 5;

/// Corners of a bilinear patch may lie this far off a common plane, relative to the patch's size: what rounding to
/// the seven digits of a float can do.
constexpr double planar_tolerance = 1e-6;

void check_indices(const std::vector<int>& indices, std::size_t vertices, const SourceLocation& where) {
    for (const int index : indices) {
        if (index < 0 || static_cast<std::size_t>(index) >= vertices)
            fail_at(where, "the index {} in \"indices\" is out of range: the mesh has {} vertices", index, vertices);
    }
}

void read_uv(Geometry& geometry, ParameterList& parameters) {
    const char* const name = parameters.has("uv") ? "uv" : "st";
    for (const V2d& uv : parameters.points2(name))
        geometry.uv.emplace_back(uv);
    if (!geometry.uv.empty() && geometry.uv.size() != geometry.positions.size())
        fail_at(parameters.where(name), "\"{}\" has {} pairs for {} vertices", name, geometry.uv.size(),
                geometry.positions.size());
}

/// Vertices, normals and indices as "trianglemesh" and "bilinearmesh" share them.
std::vector<int> read_vertices(Geometry& geometry, ParameterList& parameters, std::size_t corners) {
    geometry.positions = parameters.points("P");
    if (geometry.positions.empty())
        fail_at(parameters.where(), "{} has no vertices: the parameter \"point3 P\" is missing", parameters.owner());
    geometry.normals = parameters.normals("N");
    if (!geometry.normals.empty() && geometry.normals.size() != geometry.positions.size())
        fail_at(parameters.where("N"), "\"N\" has {} normals for {} vertices", geometry.normals.size(),
                geometry.positions.size());
    std::vector<int> indices = parameters.integers("indices");
    if (!parameters.has("indices")) {
        if (geometry.positions.size() != corners)
            fail_at(parameters.where(), "{} has {} vertices, and only with {} may \"indices\" be left out",
                    parameters.owner(), geometry.positions.size(), corners);
        indices.resize(corners);
        std::iota(indices.begin(), indices.end(), 0);
    }
    if (indices.empty() || indices.size() % corners != 0)
        fail_at(parameters.where("indices"), "\"indices\" takes groups of {}, but {} are given", corners,
                indices.size());
    check_indices(indices, geometry.positions.size(), parameters.where("indices"));
    read_uv(geometry, parameters);
    for (const char* name : {"S", "faceIndices"})
        parameters.ignore(name);
    return indices;
}

void add_triangle(Geometry& geometry, int a, int b, int c, std::size_t patch) {
    geometry.triangles.push_back(
        {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(c)});
    geometry.patches.push_back(static_cast<std::uint32_t>(patch));
}

Geometry triangle_mesh(ParameterList& parameters) {
    Geometry geometry;
    const std::vector<int> indices = read_vertices(geometry, parameters, 3);
    for (std::size_t i = 0; i < indices.size(); i += 3)
        add_triangle(geometry, indices[i], indices[i + 1], indices[i + 2], i / 3);
    return geometry;
}

/// Throws Error unless a patch p00, p10, p01, p11 is a plane convex quadrilateral: only then do two triangles have
/// the patch's points and its normal, which is along ∂p/∂u × ∂p/∂v.
void check_patch(const std::vector<V3d>& positions, const int* index, const SourceLocation& where) {
    std::array<V3d, 4> ring{}; // around the border
    for (std::size_t i = 0; i < 4; ++i)
        ring[i] = positions[static_cast<std::size_t>(index[i < 2 ? i : 5 - i])];
    std::array<V3d, 4> turns{};
    V3d normal(0.0);
    double size2 = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
        const V3d edge = ring[(i + 1) % 4] - ring[i];
        turns[i] = edge.cross(ring[(i + 2) % 4] - ring[(i + 1) % 4]);
        normal += turns[i];
        size2 = std::max({size2, edge.length2(), (ring[(i + 2) % 4] - ring[i]).length2()});
    }
    const bool has_no_side = normal.length() <= planar_tolerance * size2;
    normal.normalize();
    for (std::size_t i = 0; i < 4; ++i) {
        if (has_no_side && turns[i].length() > planar_tolerance * size2)
            fail_at(where, "a patch of \"bilinearmesh\" is not convex");
        if (std::abs((ring[i] - ring[0]).dot(normal)) > planar_tolerance * std::sqrt(size2))
            fail_at(where, "a patch of \"bilinearmesh\" is not planar, and curved patches are not supported");
        if (turns[i].dot(normal) < -planar_tolerance * size2)
            fail_at(where, "a patch of \"bilinearmesh\" is not convex");
    }
}

/// pbrt's coordinates of a patch's corners p00, p10, p01, p11, where the mesh has none: a vertex that is another corner
/// in another patch becomes several.
void set_patch_uv(Geometry& geometry, std::vector<int>& indices) {
    const std::array<V2f, 4> corners{V2f(0, 0), V2f(1, 0), V2f(0, 1), V2f(1, 1)};
    constexpr int unset = -1;
    std::vector<std::array<int, 4>> copies(geometry.positions.size(), {unset, unset, unset, unset});
    geometry.uv.resize(geometry.positions.size());
    for (std::size_t i = 0; i < indices.size(); ++i) {
        const auto vertex = static_cast<std::size_t>(indices[i]);
        std::array<int, 4>& copy = copies[vertex];
        if (copy == std::array<int, 4>{unset, unset, unset, unset}) {
            copy[i % 4] = indices[i];
            geometry.uv[vertex] = corners[i % 4];
        } else if (copy[i % 4] == unset) {
            copy[i % 4] = static_cast<int>(geometry.positions.size());
            geometry.positions.push_back(V3d(geometry.positions[vertex]));
            if (!geometry.normals.empty())
                geometry.normals.push_back(V3d(geometry.normals[vertex]));
            geometry.uv.push_back(corners[i % 4]);
        }
        indices[i] = copy[i % 4];
    }
}

Geometry bilinear_mesh(ParameterList& parameters) {
    Geometry geometry;
    if (parameters.has("emissionfilename"))
        fail_at(parameters.where("emissionfilename"), "\"emissionfilename\": image lights are not supported");
    std::vector<int> indices = read_vertices(geometry, parameters, 4);
    if (geometry.uv.empty())
        set_patch_uv(geometry, indices);
    for (std::size_t i = 0; i < indices.size(); i += 4) {
        const int* patch = &indices[i];
        check_patch(geometry.positions, patch, parameters.where("P"));
        add_triangle(geometry, patch[0], patch[1], patch[3], i / 4);
        add_triangle(geometry, patch[0], patch[3], patch[2], i / 4);
    }
    return geometry;
}

Geometry sphere(ParameterList& parameters) {
    const double radius = parameters.number("radius", 1.0);
    if (radius <= 0.0)
        fail_at(parameters.where("radius"), "\"radius\" is {}, but it must be positive", radius);
    const bool partial = parameters.number("zmin", -radius) > -radius || parameters.number("zmax", radius) < radius ||
                         parameters.number("phimax", 360.0) < 360.0;
    if (partial)
        fail_at(parameters.where(), "{}: only full spheres are supported, without \"zmin\", \"zmax\" and \"phimax\"",
                parameters.owner());
    Geometry geometry;
    static const UvSphere unit = make_uv_sphere(sphere_subdivisions);
    geometry.normals = unit.positions;
    for (const V3d& position : unit.positions)
        geometry.positions.push_back(position * radius);
    geometry.uv = unit.uv;
    geometry.triangles = unit.triangles;
    geometry.patches.assign(geometry.triangles.size(), 0);
    return geometry;
}

Geometry mesh_file(const std::string& kind, ParameterList& parameters, const PathResolver& resolve,
                   std::vector<std::string>& remarks) {
    const std::string name = parameters.text("filename", "");
    if (name.empty())
        fail_at(parameters.where(), "{} has no \"filename\"", parameters.owner());
    const MeshFormat format = kind == "plymesh" ? MeshFormat::Ply : MeshFormat::Obj;
    const SourceLocation where = parameters.where("filename");
    const MeshFile file = with_location(where, [&] { return read_mesh(resolve(name, where), format); });
    if (file.degenerate_faces > 0)
        remarks.push_back(fmt::format("dropped {} degenerate face{} of \"{}\"", file.degenerate_faces,
                                      file.degenerate_faces == 1 ? "" : "s", name));
    Geometry geometry;
    geometry.positions.assign(file.positions.begin(), file.positions.end());
    if (const double spacing = relative_spacing(geometry.positions, V3d(0.0)); spacing > coarse_spacing)
        remarks.push_back(fmt::format("the mesh in \"{}\" lies so far from its own origin that its coordinates, which "
                                      "are read in single precision, are precise to {:.2g} of its size only: expect "
                                      "flaws, as from {:.2g} on",
                                      name, spacing, coarse_spacing));
    geometry.normals.assign(file.normals.begin(), file.normals.end());
    geometry.uv = file.uv;
    geometry.triangles = file.triangles;
    geometry.patches = file.faces;
    return geometry;
}

} // namespace

Geometry make_shape(const std::string& kind, ParameterList& parameters, const PathResolver& resolve,
                    std::vector<std::string>& remarks) {
    Geometry geometry;
    if (kind == "trianglemesh")
        geometry = triangle_mesh(parameters);
    else if (kind == "bilinearmesh")
        geometry = bilinear_mesh(parameters);
    else if (kind == "sphere")
        geometry = sphere(parameters);
    else if (kind == "plymesh" || kind == "objmesh")
        geometry = mesh_file(kind, parameters, resolve, remarks);
    else
        fail_at(parameters.where(), "the shape \"{}\" is not supported", kind);
    parameters.finish();
    return geometry;
}

} // namespace tristim
