#include "mesh_target.h"

#include "scratch.h"

#include <cmath>

namespace tristim::fuzz {

namespace {

bool is_finite(const Imath::V3f& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void check(const MeshFile& mesh) {
    const std::size_t vertices = mesh.positions.size();
    require(!mesh.triangles.empty(), "a mesh has triangles");
    require(mesh.faces.size() == mesh.triangles.size(), "each triangle is part of a face");
    require(mesh.normals.empty() || mesh.normals.size() == vertices, "each vertex has a normal");
    require(mesh.uv.empty() || mesh.uv.size() == vertices, "each vertex has texture coordinates");
    require(mesh.degenerate_faces >= 0, "the number of dropped faces is not negative");
    for (const auto& triangle : mesh.triangles) {
        for (const std::uint32_t vertex : triangle)
            require(vertex < vertices, "a triangle's vertex exists");
    }
    for (const Imath::V3f& position : mesh.positions)
        require(is_finite(position), "positions are finite");
    for (const Imath::V3f& normal : mesh.normals)
        require(is_finite(normal), "normals are finite");
    for (const Imath::V2f& uv : mesh.uv)
        require(std::isfinite(uv.x) && std::isfinite(uv.y), "texture coordinates are finite");
}

} // namespace

void read_as_mesh(const std::uint8_t* data, std::size_t size, MeshFormat format) {
    static const Scratch scratch;
    const std::string path = scratch.write("mesh", {reinterpret_cast<const char*>(data), size});
    expect_value_or_error([&] { check(read_mesh(path, format)); });
}

} // namespace tristim::fuzz
