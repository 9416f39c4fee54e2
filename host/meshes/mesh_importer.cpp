#include "meshes/mesh_importer.h"

namespace tristim {

OpenMesh::VertexHandle MeshImporter::add_vertex(const OpenMesh::Vec3f& point) {
    positions.emplace_back(point[0], point[1], point[2]);
    normals_.emplace_back();
    set_for_.push_back(0);
    return VertexHandle(static_cast<int>(positions.size()) - 1);
}

OpenMesh::VertexHandle MeshImporter::add_vertex() {
    return add_vertex(OpenMesh::Vec3f(0.0f, 0.0f, 0.0f));
}

OpenMesh::FaceHandle MeshImporter::add_face(const VHandles& indices) {
    std::vector<Corner> corners;
    for (const VertexHandle handle : indices) {
        Corner corner{handle.idx(), std::nullopt};
        const auto vertex = static_cast<std::size_t>(handle.idx());
        if (handle.idx() >= 0 && vertex < normals_.size() && (!normals_by_corner_ || set_for_[vertex] == faces.size()))
            corner.normal = normals_[vertex];
        corners.push_back(corner);
    }
    faces.push_back(std::move(corners));
    return FaceHandle(static_cast<int>(faces.size()) - 1);
}

void MeshImporter::set_point(VertexHandle vertex, const OpenMesh::Vec3f& point) {
    positions.at(static_cast<std::size_t>(vertex.idx())) = {point[0], point[1], point[2]};
}

void MeshImporter::set_normal(VertexHandle vertex, const OpenMesh::Vec3f& normal) {
    const auto index = static_cast<std::size_t>(vertex.idx());
    if (vertex.idx() < 0 || index >= normals_.size())
        return;
    normals_[index] = Imath::V3f(normal[0], normal[1], normal[2]);
    set_for_[index] = faces.size();
}

void MeshImporter::set_normal(VertexHandle vertex, const OpenMesh::Vec3d& normal) {
    set_normal(vertex, OpenMesh::Vec3f(normal));
}

} // namespace tristim
