#pragma once

#include <string>
#include <vector>

namespace tristim {

/// The up to three names that are nearest to an unknown one, "a, b or c": those that contain it, then by edit distance,
/// upper and lower case alike. `names` must not be empty.
std::string near_matches(const std::string& unknown, const std::vector<std::string>& names);

} // namespace tristim
