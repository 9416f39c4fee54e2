#pragma once

#include "render/error_contrasts.h"

#include <cstdint>

namespace tristim::test {

/// Of a pass, at one level, as the kernel takes it out of what all levels have in one number.
inline std::uint32_t group_at(std::uint32_t pass, int level) {
    return error_groups(pass) >> (level * ERROR_GROUP_BITS) & (ERROR_GROUPS - 1);
}

} // namespace tristim::test
