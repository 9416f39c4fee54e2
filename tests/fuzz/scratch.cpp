#include "scratch.h"

#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <unistd.h>

namespace tristim::fuzz {

Scratch::Scratch() {
    std::string pattern = (std::filesystem::temp_directory_path() / "tristim-fuzz-XXXXXX").string();
    require(::mkdtemp(pattern.data()) != nullptr, "the temporary directory can be written to");
    folder_ = pattern;
}

Scratch::~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
}

std::string Scratch::write(const std::string& name, std::string_view bytes) const {
    const std::string file_path = path(name);
    const int file = ::open(file_path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    const bool is_written =
        file >= 0 && ::write(file, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
    if (file >= 0)
        ::close(file);
    require(is_written, "a file in the temporary directory can be written");
    return file_path;
}

void Scratch::remove(const std::string& name) const {
    ::unlink(path(name).c_str());
}

void require(bool condition, const char* what) {
    if (condition)
        return;
    std::fprintf(stderr, "tristim: this does not hold: %s\n", what);
    std::abort();
}

} // namespace tristim::fuzz
