#pragma once

#include <Imath/ImathVec.h>
#include <OpenMesh/Core/IO/importer/BaseImporter.hh>

#include <optional>
#include <vector>

namespace tristim {

/// Takes the vertices and faces that an OpenMesh reader finds just as they stand in the file. OpenMesh's own importers
/// drop faces that do not fit a half-edge structure; this one keeps them, so that they can be reported.
class MeshImporter : public OpenMesh::IO::BaseImporter {
  public:
    /// `by_corner`: the reader sets normals and texture coordinates anew for the corners of each face before it adds
    /// the face (OBJ), instead of once for each vertex (PLY).
    explicit MeshImporter(bool by_corner) : by_corner_(by_corner) {}

    struct Corner {
        int vertex; ///< as in the file: perhaps out of range
        std::optional<Imath::V3f> normal;
        std::optional<Imath::V2f> uv;
    };

    std::vector<Imath::V3f> positions;
    std::vector<std::vector<Corner>> faces;

    using VertexHandle = OpenMesh::VertexHandle;
    using EdgeHandle = OpenMesh::EdgeHandle;
    using HalfedgeHandle = OpenMesh::HalfedgeHandle;
    using FaceHandle = OpenMesh::FaceHandle;

    VertexHandle add_vertex(const OpenMesh::Vec3f& point) override;
    VertexHandle add_vertex() override;
    FaceHandle add_face(const VHandles& indices) override;
    void set_point(VertexHandle vertex, const OpenMesh::Vec3f& point) override;
    void set_normal(VertexHandle vertex, const OpenMesh::Vec3f& normal) override;
    void set_normal(VertexHandle vertex, const OpenMesh::Vec3d& normal) override;
    void set_texcoord(VertexHandle vertex, const OpenMesh::Vec2f& uv) override;
    size_t n_vertices() const override { return positions.size(); }
    size_t n_faces() const override { return faces.size(); }
    size_t n_edges() const override { return 0; }

    // What else readers may tell is not wanted.
    HalfedgeHandle add_edge(VertexHandle, VertexHandle) override { return HalfedgeHandle(); }
    FaceHandle add_face(HalfedgeHandle) override { return FaceHandle(); }
    void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<OpenMesh::Vec2f>&) override {}
    void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<OpenMesh::Vec3f>&) override {}
    void set_face_texindex(FaceHandle, int) override {}
    void set_halfedge(VertexHandle, HalfedgeHandle) override {}
    void set_color(VertexHandle, const OpenMesh::Vec3uc&) override {}
    void set_color(VertexHandle, const OpenMesh::Vec4uc&) override {}
    void set_color(VertexHandle, const OpenMesh::Vec3f&) override {}
    void set_color(VertexHandle, const OpenMesh::Vec4f&) override {}
    void set_status(VertexHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void set_next(HalfedgeHandle, HalfedgeHandle) override {}
    void set_face(HalfedgeHandle, FaceHandle) override {}
    void request_face_texcoords2D() override {}
    void set_texcoord(HalfedgeHandle, const OpenMesh::Vec2f&) override {}
    void set_texcoord(VertexHandle, const OpenMesh::Vec3f&) override {}
    void set_texcoord(HalfedgeHandle, const OpenMesh::Vec3f&) override {}
    void set_status(HalfedgeHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void set_color(EdgeHandle, const OpenMesh::Vec3uc&) override {}
    void set_color(EdgeHandle, const OpenMesh::Vec4uc&) override {}
    void set_color(EdgeHandle, const OpenMesh::Vec3f&) override {}
    void set_color(EdgeHandle, const OpenMesh::Vec4f&) override {}
    void set_status(EdgeHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void set_normal(FaceHandle, const OpenMesh::Vec3f&) override {}
    void set_normal(FaceHandle, const OpenMesh::Vec3d&) override {}
    void set_color(FaceHandle, const OpenMesh::Vec3uc&) override {}
    void set_color(FaceHandle, const OpenMesh::Vec4uc&) override {}
    void set_color(FaceHandle, const OpenMesh::Vec3f&) override {}
    void set_color(FaceHandle, const OpenMesh::Vec4f&) override {}
    void set_status(FaceHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void add_texture_information(int, std::string) override {}

  private:
    /// What the reader has told of a vertex beside its position.
    template <typename Value>
    struct Attribute {
        std::optional<Value> value; ///< as set last
        std::size_t set_for = 0;    ///< the number of faces when it was set
    };

    template <typename Value>
    void set(std::vector<Attribute<Value>>& attributes, VertexHandle vertex, const Value& value);
    template <typename Value>
    std::optional<Value> get(const std::vector<Attribute<Value>>& attributes, VertexHandle vertex) const;

    bool by_corner_;
    std::vector<Attribute<Imath::V3f>> normals_; ///< per vertex
    std::vector<Attribute<Imath::V2f>> uv_;
};

} // namespace tristim
