#include "render/statistics.h"

#include <fmt/format.h>

namespace tristim {

std::string describe(const NonFiniteCounts& counts) {
    return fmt::format("eye {}, photon {}, gather {}, film {}", counts.eye, counts.photon, counts.gather, counts.film);
}

} // namespace tristim
