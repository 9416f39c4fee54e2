#include "meshes/mesh_io.h"

#include "base/error.h"
#include "base/read_file.h"
#include "meshes/mesh_checks.h"
#include "meshes/mesh_importer.h"
#include "meshes/ply_header.h"
#include "meshes/triangulate.h"

// MeshIO.hh makes the linker keep OpenMesh's readers, which register themselves.
#include <OpenMesh/Core/IO/MeshIO.hh>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace tristim {

namespace {

/// Silences OpenMesh's chatter while in scope.
class QuietOpenMesh {
  public:
    QuietOpenMesh() : was_enabled_(omerr().is_enabled()) { omerr().disable(); }
    ~QuietOpenMesh() {
        if (was_enabled_)
            omerr().enable();
    }
    QuietOpenMesh(const QuietOpenMesh&) = delete;
    QuietOpenMesh& operator=(const QuietOpenMesh&) = delete;

  private:
    bool was_enabled_;
};

void import_ply(const std::string& path, const std::string& bytes, MeshImporter& importer) {
    const PlyHeader header = read_ply_header(path, bytes);
    std::istringstream stream(header.text + bytes.substr(header.body_offset), std::ios::binary);
    // The reader does not look whether its reads succeed; the exception stops it where the file ends or is no number.
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    OpenMesh::IO::Options options = OpenMesh::IO::Options::VertexNormal;
    options += OpenMesh::IO::Options::VertexTexCoord;
    bool whole = false;
    try {
        whole = OpenMesh::IO::IOManager().read(stream, "ply", importer, options);
    } catch (const std::ios::failure&) {
        whole = false;
    }
    if (!whole || importer.positions.size() != header.vertices || importer.faces.size() != header.faces)
        fail("{}: the PLY file is cut short or malformed: {} of {} vertices and {} of {} faces could be read", path,
             importer.positions.size(), header.vertices, importer.faces.size(), header.faces);
}

std::size_t import_obj(const std::string& path, const std::string& bytes, MeshImporter& importer) {
    CheckedObj checked = check_obj(path, bytes);
    std::istringstream stream(std::move(checked.text));
    OpenMesh::IO::Options options = OpenMesh::IO::Options::VertexNormal;
    options += OpenMesh::IO::Options::VertexTexCoord;
    if (!OpenMesh::IO::IOManager().read(stream, "obj", importer, options) ||
        importer.positions.size() != checked.vertices)
        fail("{}: the OBJ file is malformed", path);
    // OpenMesh leaves out faces with fewer than three different vertices.
    return checked.faces - importer.faces.size();
}

void check_vertices(const std::string& path, const MeshImporter& importer, int first_index) {
    for (std::size_t i = 0; i < importer.positions.size(); ++i) {
        const Imath::V3f& p = importer.positions[i];
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
            fail("{}: the vertex {} is not finite: ({}, {}, {})", path, i + static_cast<std::size_t>(first_index), p.x,
                 p.y, p.z);
    }
    for (std::size_t f = 0; f < importer.faces.size(); ++f) {
        if (importer.faces[f].size() > max_face_corners)
            fail("{}: face {} has {} corners, and more than {} are not supported", path, f, importer.faces[f].size(),
                 max_face_corners);
        for (const auto& corner : importer.faces[f]) {
            if (corner.vertex < 0 || static_cast<std::size_t>(corner.vertex) >= importer.positions.size())
                fail("{}: the vertex index {} of face {} is out of range: the mesh has {} vertices", path,
                     corner.vertex, f, importer.positions.size());
            if (corner.normal && !std::isfinite(corner.normal->length2()))
                fail("{}: the normal of vertex {} is not finite", path, corner.vertex + first_index);
            if (corner.uv && !std::isfinite(corner.uv->length2()))
                fail("{}: the texture coordinates of vertex {} are not finite", path, corner.vertex + first_index);
        }
    }
}

/// Faces without repeated vertices; the ones left with fewer than three vanish.
std::vector<std::vector<MeshImporter::Corner>> proper_faces(const MeshImporter& importer) {
    std::vector<std::vector<MeshImporter::Corner>> result;
    for (const auto& face : importer.faces) {
        std::vector<MeshImporter::Corner> corners;
        for (const auto& corner : face) {
            const auto is_same = [&](const auto& other) { return other.vertex == corner.vertex; };
            if (std::none_of(corners.begin(), corners.end(), is_same))
                corners.push_back(corner);
        }
        if (corners.size() >= 3)
            result.push_back(std::move(corners));
    }
    return result;
}

/// Gives every vertex with one normal and one pair of texture coordinates an output vertex of its own.
class VertexTable {
  public:
    VertexTable(const MeshImporter& importer, bool with_normals, bool with_uv, MeshFile& mesh)
        : importer_(importer), with_normals_(with_normals), with_uv_(with_uv), mesh_(mesh),
          copies_(importer.positions.size()) {}

    std::uint32_t index(const MeshImporter::Corner& corner) {
        const auto vertex = static_cast<std::size_t>(corner.vertex);
        const Imath::V3f normal = corner.normal.value_or(Imath::V3f(0.0f));
        const Imath::V2f uv = corner.uv.value_or(Imath::V2f(0.0f));
        for (const std::uint32_t copy : copies_[vertex]) {
            if ((!with_normals_ || mesh_.normals[copy] == normal) && (!with_uv_ || mesh_.uv[copy] == uv))
                return copy;
        }
        copies_[vertex].push_back(static_cast<std::uint32_t>(mesh_.positions.size()));
        mesh_.positions.push_back(importer_.positions[vertex]);
        if (with_normals_)
            mesh_.normals.push_back(normal);
        if (with_uv_)
            mesh_.uv.push_back(uv);
        return copies_[vertex].back();
    }

  private:
    const MeshImporter& importer_;
    bool with_normals_;
    bool with_uv_;
    MeshFile& mesh_;
    std::vector<std::vector<std::uint32_t>> copies_; ///< per vertex of the file
};

/// Corners without a normal in a mesh that has some get their face's, so that they stay flat. In double precision, as
/// products of large coordinates leave the range of float.
void complete_normals(const MeshImporter& importer, std::vector<MeshImporter::Corner>& face) {
    const auto position = [&](const MeshImporter::Corner& corner) {
        return Imath::V3d(importer.positions[static_cast<std::size_t>(corner.vertex)]);
    };
    const Imath::V3d origin = position(face[0]);
    Imath::V3d sum(0.0);
    for (std::size_t i = 1; i + 1 < face.size(); ++i)
        sum += (position(face[i]) - origin).cross(position(face[i + 1]) - origin);
    const Imath::V3f normal(sum.normalized());
    for (auto& corner : face) {
        if (!corner.normal)
            corner.normal = normal;
    }
}

MeshFile to_triangles(const MeshImporter& importer, std::vector<std::vector<MeshImporter::Corner>> faces) {
    MeshFile mesh;
    const auto some_corner = [&faces](auto condition) {
        return std::any_of(faces.begin(), faces.end(),
                           [&](const auto& face) { return std::any_of(face.begin(), face.end(), condition); });
    };
    const bool with_normals = some_corner([](const auto& corner) { return corner.normal.has_value(); });
    const bool with_uv = some_corner([](const auto& corner) { return corner.uv.has_value(); });
    VertexTable table(importer, with_normals, with_uv, mesh);
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (with_normals)
            complete_normals(importer, faces[f]);
        std::vector<std::uint32_t> indices;
        std::vector<Imath::V3f> corners;
        for (const auto& corner : faces[f]) {
            indices.push_back(table.index(corner));
            corners.push_back(mesh.positions[indices.back()]);
        }
        for (const auto& [a, b, c] : triangulate(corners)) {
            mesh.triangles.push_back({indices[a], indices[b], indices[c]});
            mesh.faces.push_back(static_cast<std::uint32_t>(f));
        }
    }
    return mesh;
}

Faces vertex_lists(const std::vector<std::vector<MeshImporter::Corner>>& faces) {
    Faces lists;
    for (const auto& face : faces) {
        std::vector<int>& list = lists.emplace_back();
        for (const auto& corner : face)
            list.push_back(corner.vertex);
    }
    return lists;
}

} // namespace

MeshFile read_mesh(const std::string& path, MeshFormat format) {
    const std::string bytes = read_whole_file(path);
    const QuietOpenMesh quiet;
    const bool is_obj = format == MeshFormat::Obj;
    const int first_index = is_obj ? 1 : 0;
    MeshImporter importer(is_obj);
    std::size_t left_out = 0;
    if (is_obj)
        left_out = import_obj(path, bytes, importer);
    else
        import_ply(path, bytes, importer);
    check_vertices(path, importer, first_index);

    std::vector<std::vector<MeshImporter::Corner>> faces = proper_faces(importer);
    left_out += importer.faces.size() - faces.size();
    if (faces.empty())
        fail("{}: the mesh is empty: it has {} vertices and no face of three different ones", path,
             importer.positions.size());
    check_manifold(path, vertex_lists(faces), importer.positions.size(), first_index);
    MeshFile mesh = to_triangles(importer, std::move(faces));
    mesh.degenerate_faces = static_cast<int>(left_out);
    return mesh;
}

} // namespace tristim
