#pragma once

#include "base/error.h"

#include <memory>
#include <string>
#include <utility>

namespace tristim {

/// A line of a scene file, for messages; or none, of what was not read from a file. Lines count from 1.
struct SourceLocation {
    std::shared_ptr<const std::string> file;
    int line = 0;

    /// "file:line", or nothing
    std::string text() const { return file ? fmt::format("{}:{}", *file, line) : ""; }
};

/// Throws Error "file:line: message".
template <typename... Args>
[[noreturn]] void fail_at(const SourceLocation& where, fmt::format_string<Args...> format, Args&&... args) {
    throw Error(fmt::format("{}: {}", where.text(), fmt::format(format, std::forward<Args>(args)...)));
}

/// Calls a function that knows nothing of scene files and puts "file:line: " before the Error that it throws.
template <typename Function>
auto with_location(const SourceLocation& where, Function&& function) -> decltype(function()) {
    try {
        return function();
    } catch (const Error& error) {
        throw Error(where.text() + ": " + error.what());
    }
}

} // namespace tristim
