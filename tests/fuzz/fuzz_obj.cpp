// OBJ files through read_mesh().

#include "line_mutator.h"
#include "mesh_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    tristim::fuzz::read_as_mesh(data, size, tristim::MeshFormat::Obj);
    return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
    return tristim::fuzz::mutate_text(data, size, max_size, seed);
}
