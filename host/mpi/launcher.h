#pragma once

#include <optional>
#include <string>

namespace tristim {

/// What started this process as one of several ranks, so far as the environment tells.
struct Launcher {
    std::string name;
    int size = 0; ///< ranks; 0 if it does not say
};

/// None if the process was started alone.
std::optional<Launcher> find_launcher();

/// Whether the launcher has bound this process to so few cores that as many processes as are on this machine leave some
/// idle: what to do about it, or empty.
std::string binding_note(int local_ranks);

} // namespace tristim
