#pragma once

#include <fmt/format.h>
#include <string_view>
#include <utility>

namespace tristim {

/// Writes to stderr as far as that goes: it may be closed, on a full disk, or a pipe that nobody empties, which holds
/// no one up for longer than a second. None of these is a reason to lose a render.
void tell_text(std::string_view text);

template <typename... Args>
void tell(fmt::format_string<Args...> format, Args&&... args) {
    tell_text(fmt::format(format, std::forward<Args>(args)...));
}

} // namespace tristim
