#pragma once

#include <string>
#include <vector>

namespace tristim {

/// The parts of a text between separators; one more than there are separators, any of them may be empty.
inline std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0;;) {
        const std::size_t end = text.find(separator, begin);
        parts.push_back(text.substr(begin, end == text.npos ? end : end - begin));
        if (end == text.npos)
            return parts;
        begin = end + 1;
    }
}

} // namespace tristim
