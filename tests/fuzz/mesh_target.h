#pragma once

#include "meshes/mesh_io.h"

#include <cstddef>
#include <cstdint>

namespace tristim::fuzz {

/// Reads the bytes as a mesh file and checks what read_mesh() promises: it throws an Error, or all indices are in range
/// and all numbers finite.
void read_as_mesh(const std::uint8_t* data, std::size_t size, MeshFormat format);

} // namespace tristim::fuzz
