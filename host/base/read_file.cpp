#include "base/read_file.h"

#include "base/error.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace tristim {

void refuse_device(const std::string& path) {
    std::error_code ignored;
    if (std::filesystem::is_character_file(path, ignored) || std::filesystem::is_block_file(path, ignored))
        fail("cannot read \"{}\": it is a device", path);
}

std::string read_whole_file(const std::string& path) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored))
        fail("cannot read \"{}\": it is a folder", path);
    refuse_device(path);
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    if (!file)
        fail("cannot open \"{}\": {}", path, std::strerror(errno));
    std::string bytes{std::istreambuf_iterator<char>(file), {}};
    if (file.bad())
        fail("cannot read \"{}\": {}", path, std::strerror(errno));
    return bytes;
}

} // namespace tristim
