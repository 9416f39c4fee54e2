#pragma once

#include <string>

namespace tristim {

/// The bytes of a file. Throws Error naming the file if it is missing, is a folder or cannot be read.
std::string read_whole_file(const std::string& path);

} // namespace tristim
