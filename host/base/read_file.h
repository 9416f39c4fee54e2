#pragma once

#include <string>

namespace tristim {

/// Throws Error if the path is a device: reading a terminal or /dev/zero would not end. A pipe may well be meant.
void refuse_device(const std::string& path);

/// The bytes of a file. Throws Error naming the file if it is missing, is a folder, a device or cannot be read.
std::string read_whole_file(const std::string& path);

} // namespace tristim
