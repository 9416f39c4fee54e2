#pragma once

#include <cstddef>
#include <string>

namespace tristim {

/// What the header of a PLY file says, and the file as OpenMesh's reader can safely take it: that reader trusts
/// headers, so this one is checked first and written anew, without properties that are not needed by name.
struct PlyHeader {
    std::size_t vertices = 0;
    std::size_t faces = 0;
    std::string text;            ///< from "ply" to "end_header\n"
    std::size_t body_offset = 0; ///< where the file's data begin
};

/// Throws Error "path: …" or "path:line: …" unless `bytes` begins with a well-formed header: format 1.0 of any of the
/// three encodings, an element "vertex" with x, y, z (and nx, ny, nz or none of them) of type float or double, and
/// after it an element "face" whose first property and only list is "vertex_indices" (or "vertex_index"); nor if the
/// header promises more elements than the file has room for.
PlyHeader read_ply_header(const std::string& path, const std::string& bytes);

} // namespace tristim
