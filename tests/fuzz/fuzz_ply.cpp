// PLY files, text or binary, through read_mesh().

#include "line_mutator.h"
#include "mesh_target.h"

#include <algorithm>
#include <string>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    tristim::fuzz::read_as_mesh(data, size, tristim::MeshFormat::Ply);
    return 0;
}

/// Changes by lines and words, or of bytes, half of them behind the header alone.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
    static const std::string end_of_header = "end_header\n";
    std::uint8_t* const found = std::search(data, data + size, end_of_header.begin(), end_of_header.end());
    const std::size_t header = static_cast<std::size_t>(found - data) + end_of_header.size();
    if (seed % 2 == 0 || header >= size)
        return tristim::fuzz::mutate_text(data, size, max_size, seed / 2);
    return header + LLVMFuzzerMutate(data + header, size - header, max_size - header);
}
