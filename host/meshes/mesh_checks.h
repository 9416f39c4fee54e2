#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tristim {

/// Faces as lists of vertex indices, all in range and different within a face.
using Faces = std::vector<std::vector<int>>;

/// Throws Error "path: …" unless the faces form an oriented 2-manifold, with or without borders: every edge has one or
/// two faces, two neighbours run through their edge in opposite directions, and the faces around a vertex form one fan.
/// Vertices are numbered from `first_index` in the message.
void check_manifold(const std::string& path, const Faces& faces, std::size_t vertices, int first_index);

/// What a look at the text of an OBJ file says, and the file as OpenMesh's reader can safely take it: that reader skips
/// lines that it cannot read, follows "mtllib" to any file, takes more characters for blanks than stand in OBJ files,
/// and mixes up the third numbers of "vt" lines where only some have one.
struct CheckedObj {
    std::size_t vertices = 0;
    std::size_t faces = 0;
    std::string text; ///< the "v", "vt", "vn" and "f" lines, with the numbers that count
};

/// Throws Error "path:line: …" for numbers that are malformed or not finite and for indices that are malformed or out
/// of range in "v", "vt" (u and v), "vn" and "f" lines.
CheckedObj check_obj(const std::string& path, std::string_view text);

/// The most corners that a face may have: cutting it into triangles takes a time that grows with their square.
inline constexpr std::size_t max_face_corners = 10000;

} // namespace tristim
