#pragma once

#include "base/error.h"

#include <filesystem>
#include <string>
#include <string_view>

namespace tristim::fuzz {

/// A folder under the temporary directory for the files that a target hands to the loaders, gone at exit.
class Scratch {
  public:
    Scratch();
    ~Scratch();
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;

    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    /// Writes a file and returns its path.
    std::string write(const std::string& name, std::string_view bytes) const;

    void remove(const std::string& name) const;

  private:
    std::filesystem::path folder_;
};

/// Ends the run as a failure unless `condition` holds. `what` says what ought to hold.
void require(bool condition, const char* what);

/// Calls a function that may throw an Error with a sentence, and nothing else.
template <typename Function>
void expect_value_or_error(Function&& function) {
    try {
        function();
    } catch (const Error& error) {
        require(*error.what() != '\0', "an error says something");
    }
}

} // namespace tristim::fuzz
