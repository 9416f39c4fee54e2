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

/// What a look at the text of an OBJ file says before OpenMesh, which skips lines that it cannot read, gets it.
struct ObjCounts {
    std::size_t vertices = 0;
    std::size_t faces = 0;
    bool has_w = false; ///< a "vt" line has a third number
};

/// Throws Error "path:line: …" for numbers that are malformed or not finite and for indices that are malformed or out
/// of range in "v", "vt" (u and v), "vn" and "f" lines.
ObjCounts check_obj(const std::string& path, std::string_view text);

/// The text of an OBJ file with blanks for all but the first two numbers of "vt" lines: where only some have a third,
/// OpenMesh mixes them up.
std::string without_w(std::string text);

} // namespace tristim
