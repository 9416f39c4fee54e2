#include "meshes/mesh_importer.h"

namespace tristim {

template <typename Value>
void MeshImporter::set(std::vector<Attribute<Value>>& attributes, VertexHandle vertex, const Value& value) {
    const auto index = static_cast<std::size_t>(vertex.idx());
    if (vertex.idx() >= 0 && index < attributes.size())
        attributes[index] = {value, faces.size()};
}

template <typename Value>
std::optional<Value> MeshImporter::get(const std::vector<Attribute<Value>>& attributes, VertexHandle vertex) const {
    const auto index = static_cast<std::size_t>(vertex.idx());
    if (vertex.idx() < 0 || index >= attributes.size() || (by_corner_ && attributes[index].set_for != faces.size()))
        return std::nullopt;
    return attributes[index].value;
}

OpenMesh::VertexHandle MeshImporter::add_vertex(const OpenMesh::Vec3f& point) {
    positions.emplace_back(point[0], point[1], point[2]);
    normals_.emplace_back();
    uv_.emplace_back();
    return VertexHandle(static_cast<int>(positions.size()) - 1);
}

OpenMesh::VertexHandle MeshImporter::add_vertex() {
    return add_vertex(OpenMesh::Vec3f(0.0f, 0.0f, 0.0f));
}

OpenMesh::FaceHandle MeshImporter::add_face(const VHandles& indices) {
    std::vector<Corner> corners;
    for (const VertexHandle handle : indices)
        corners.push_back({handle.idx(), get(normals_, handle), get(uv_, handle)});
    faces.push_back(std::move(corners));
    return FaceHandle(static_cast<int>(faces.size()) - 1);
}

void MeshImporter::set_point(VertexHandle vertex, const OpenMesh::Vec3f& point) {
    positions.at(static_cast<std::size_t>(vertex.idx())) = {point[0], point[1], point[2]};
}

void MeshImporter::set_normal(VertexHandle vertex, const OpenMesh::Vec3f& normal) {
    set(normals_, vertex, Imath::V3f(normal[0], normal[1], normal[2]));
}

void MeshImporter::set_normal(VertexHandle vertex, const OpenMesh::Vec3d& normal) {
    set_normal(vertex, OpenMesh::Vec3f(normal));
}

void MeshImporter::set_texcoord(VertexHandle vertex, const OpenMesh::Vec2f& uv) {
    set(uv_, vertex, Imath::V2f(uv[0], uv[1]));
}

} // namespace tristim
