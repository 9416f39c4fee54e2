#pragma once

#include <cctype>
#include <string>

namespace tristim::test {

/// What GoogleTest takes as a name: letters, digits and '_'.
inline std::string test_name(std::string text) {
    for (char& c : text)
        c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
    return text;
}

} // namespace tristim::test
