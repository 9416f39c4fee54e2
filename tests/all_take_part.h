#pragma once

#include "render/team.h"

#include <algorithm>

namespace tristim::test {

constexpr int most_attempts = 10;

/// What `render` returns when all devices have rendered passes: on a busy machine one may come to its first pass when
/// all are done, and it is rendered once more.
template <typename Render>
RenderOutcome render_until_all_take_part(const Render& render) {
    const auto took_part = [](const DeviceShare& share) { return share.passes > 0; };
    RenderOutcome outcome = render();
    for (int attempt = 1; attempt < most_attempts && !std::ranges::all_of(outcome.shares, took_part); ++attempt)
        outcome = render();
    return outcome;
}

} // namespace tristim::test
