#pragma once

#include "base/error.h"
#include "scene/scene.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace tristim::test {

/// A temporary folder for scene and mesh files, gone when it goes out of scope.
class SceneFolder {
  public:
    SceneFolder() {
        std::string pattern = (std::filesystem::temp_directory_path() / "tristim-test-XXXXXX").string();
        folder_ = ::mkdtemp(pattern.data());
    }
    ~SceneFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }
    SceneFolder(const SceneFolder&) = delete;
    SceneFolder& operator=(const SceneFolder&) = delete;

    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    /// Writes a file and returns its path.
    std::string write(const std::string& name, const std::string& bytes) const {
        std::ofstream(path(name), std::ios::binary) << bytes;
        return path(name);
    }

    Scene load(const std::string& text) const { return load_scene(write("scene.pbrt", text)); }

  private:
    std::filesystem::path folder_;
};

/// The bytes of a file; none if it cannot be read.
inline std::string read_text(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// The message of the Error that a call throws; fails the test if it throws none.
template <typename Function>
std::string error_of(Function&& function) {
    try {
        function();
    } catch (const Error& error) {
        return error.what();
    }
    ADD_FAILURE() << "no Error was thrown";
    return {};
}

/// Adds failures unless a message is one line that starts so (file and line) and holds the words.
inline void expect_message(const std::string& message, const std::string& start, const std::string& words) {
    EXPECT_EQ(message.rfind(start, 0), 0u) << message;
    EXPECT_NE(message.find(words), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

/// A whole scene around a piece of the world block.
inline std::string with_world(const std::string& world) {
    return "Camera \"perspective\"\nWorldBegin\n" + world;
}

/// The same with a light and a triangle, so that only the piece can be at fault. The piece begins at line 5.
inline std::string with_lit_world(const std::string& world) {
    return with_world("LightSource \"point\"\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n" + world);
}

} // namespace tristim::test
