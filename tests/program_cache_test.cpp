// Cached programs: what a binary is found by, and that nothing wrong with the cache is ever an error.
#include "child_process.h"
#include "opencl/program.h"
#include "opencl/program_cache.h"
#include "scene_folder.h"
#include "test_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <thread>

namespace tristim::test {
namespace {

namespace fs = std::filesystem;

const ProgramKey a_key{"platform 1", "device", "driver", "", "-D A=1", "kernel void f() {}"};
const ProgramBinary a_binary{1, 2, 3, 0, 255, 4};

/// A cache in a folder of its own, and what it noted.
struct Fixture {
    explicit Fixture(std::uintmax_t limit = ProgramCache::usual_limit)
        : cache(
              folder.path("cache"), [this](const std::string& what) { notes.push_back(what); }, limit) {}

    SceneFolder folder;
    std::vector<std::string> notes;
    ProgramCache cache;
};

std::string contents(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

void overwrite(const fs::path& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
}

TEST(ProgramCache, GivesBackWhatWasStoredUnderTheWholeKeyAlone) {
    Fixture f;
    EXPECT_FALSE(f.cache.load(a_key).has_value());
    f.cache.store(a_key, a_binary);
    EXPECT_EQ(f.cache.load(a_key), a_binary);
    for (std::string ProgramKey::*field : {&ProgramKey::platform, &ProgramKey::device, &ProgramKey::driver,
                                           &ProgramKey::environment, &ProgramKey::options, &ProgramKey::source}) {
        ProgramKey other = a_key;
        other.*field += ' ';
        EXPECT_FALSE(f.cache.load(other).has_value());
        f.cache.store(other, {9});
    }
    ProgramKey shifted = a_key; // the same characters, otherwise divided
    shifted.platform = "platform 1d";
    shifted.device = "evice";
    EXPECT_FALSE(f.cache.load(shifted).has_value());
    EXPECT_EQ(f.cache.load(a_key), a_binary);
    EXPECT_TRUE(f.notes.empty()) << f.notes.front();
}

TEST(ProgramCache, FindsEveryTruncationAndEveryChangedByte) {
    Fixture f;
    f.cache.store(a_key, a_binary);
    const fs::path file = f.cache.file(a_key);
    const std::string good = contents(file);
    for (std::size_t i = 0; i < good.size(); ++i) {
        overwrite(file, good.substr(0, i));
        EXPECT_FALSE(f.cache.load(a_key).has_value()) << "cut at " << i;
        std::string bad = good;
        bad[i] = static_cast<char>(bad[i] ^ 1);
        overwrite(file, bad);
        EXPECT_FALSE(f.cache.load(a_key).has_value()) << "byte " << i;
    }
    overwrite(file, good + '\0');
    EXPECT_FALSE(f.cache.load(a_key).has_value());
    EXPECT_EQ(f.notes.size(), 1U) << "one note, not one for each";
    EXPECT_NE(f.notes.front().find(file.string()), std::string::npos) << f.notes.front();
    f.cache.store(a_key, a_binary); // replaces the damaged one
    EXPECT_EQ(f.cache.load(a_key), a_binary);
}

TEST(ProgramCache, RefusesAFileOfAnotherProgram) {
    Fixture f;
    ProgramKey other = a_key;
    other.source += "// as long";
    ProgramKey same_length = a_key;
    same_length.source.back() = ' ';
    for (const ProgramKey& key : {other, same_length}) {
        f.cache.store(key, a_binary);
        fs::rename(f.cache.file(key), f.cache.file(a_key));
        EXPECT_FALSE(f.cache.load(a_key).has_value());
    }
    overwrite(f.cache.file(a_key), "#!/bin/sh\n");
    EXPECT_FALSE(f.cache.load(a_key).has_value());
    EXPECT_EQ(f.notes.size(), 1U);
}

TEST(ProgramCache, NotesAFolderThatCannotBeWritten) {
    Fixture f;
    overwrite(f.folder.path("cache"), "a file where the folder should be"); // unwritable for root, too
    f.cache.store(a_key, a_binary);
    f.cache.store(a_key, a_binary);
    EXPECT_FALSE(f.cache.load(a_key).has_value());
    ASSERT_EQ(f.notes.size(), 1U);
    EXPECT_NE(f.notes.front().find("cannot be cached"), std::string::npos) << f.notes.front();
}

TEST(ProgramCache, ConcurrentWritersLeaveOneWholeFile) {
    Fixture f;
    const ProgramBinary large(100'000, 7);
    std::vector<std::thread> threads;
    std::atomic<int> wrong = 0;
    for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&] {
            for (int i = 0; i < 25; ++i) {
                f.cache.store(a_key, large);
                wrong += f.cache.load(a_key) == large ? 0 : 1;
            }
        });
    }
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_EQ(wrong, 0);
    EXPECT_TRUE(f.notes.empty()) << f.notes.front();
    EXPECT_EQ(std::distance(fs::directory_iterator(f.folder.path("cache")), {}), 1) << "temporary files are left";
}

TEST(ProgramCache, RemovesWhatWentUnreadTheLongest) {
    Fixture f(5000);
    std::vector<ProgramKey> keys;
    for (int i = 0; i < 6; ++i) {
        ProgramKey key = a_key;
        key.options = "-D I=" + std::to_string(i);
        f.cache.store(key, ProgramBinary(1000, 1));
        // The first is read last; times are set since clocks of file systems may be coarse.
        fs::last_write_time(f.cache.file(key),
                            fs::file_time_type::clock::now() - std::chrono::hours(i == 0 ? 0 : 10 - i));
        keys.push_back(key);
    }
    EXPECT_TRUE(f.cache.load(keys[0]).has_value());
    EXPECT_FALSE(f.cache.load(keys[1]).has_value());
    EXPECT_TRUE(f.cache.load(keys[5]).has_value());
    EXPECT_TRUE(f.notes.empty());
}

/// Where PoCL keeps its own files, which it must be able to write: without a cache it has no device.
std::string pocl_cache() {
    const auto variable = [](const char* name) {
        const char* value = std::getenv(name);
        return std::string(value != nullptr ? value : "");
    };
    if (const std::string folder = variable("POCL_CACHE_DIR"); !folder.empty())
        return folder;
    const std::string xdg = variable("XDG_CACHE_HOME");
    return (xdg.empty() ? variable("HOME") + "/.cache" : xdg) + "/pocl/kcache";
}

/// A cache of its own: made by the first start, of use to the second, and never in the way.
class CachedRender : public testing::Test {
  protected:
    /// Renders a small image to a file, and returns what it said about the cache.
    std::string render(const std::string& image) const {
        const ChildResult result = run_tristim(
            {"render", std::string(TRISTIM_SOURCE_DIR) + "/meshes/dispersion/scene.pbrt", "--quiet", "--resolution",
             "8x8", "--photons", "256", "--passes", "1", "--device", "Portable Computing Language", "--outfile",
             folder.path(image)},
            {{"XDG_CACHE_HOME", folder.path("xdg")}, {"POCL_CACHE_DIR", pocl_cache()}, {"TRISTIM_PROGRAM_CACHE", "1"}});
        EXPECT_EQ(result.exit_code, 0) << result.standard_error;
        const std::size_t note = result.standard_error.find("note: ");
        return note == std::string::npos ? "" : result.standard_error.substr(note);
    }

    std::vector<fs::path> files() const {
        std::vector<fs::path> paths;
        for (const auto& entry : fs::directory_iterator(folder.path("xdg") + "/tristim"))
            paths.push_back(entry.path());
        return paths;
    }

    SceneFolder folder;
};

TEST_F(CachedRender, SurvivesEveryStateOfTheCache) {
    EXPECT_EQ(render("a.png"), "");
    const std::string image = contents(folder.path("a.png"));
    ASSERT_FALSE(image.empty());
    ASSERT_GE(files().size(), 5U);

    EXPECT_EQ(render("b.png"), "");
    EXPECT_EQ(contents(folder.path("b.png")), image) << "another image from cached programs";

    for (const fs::path& path : files())
        overwrite(path, contents(path).substr(0, 1000));
    const std::string damaged = render("c.png");
    EXPECT_NE(damaged.find("are not used and built anew: the file is damaged"), std::string::npos) << damaged;
    EXPECT_EQ(std::count(damaged.begin(), damaged.end(), '\n'), 1) << damaged;
    EXPECT_EQ(contents(folder.path("c.png")), image);
    for (const fs::path& path : files())
        EXPECT_GT(fs::file_size(path), 1000U) << "damaged files are replaced";

    fs::remove_all(folder.path("xdg"));
    overwrite(folder.path("xdg"), "no folder");
    const std::string unwritable = render("d.png");
    EXPECT_NE(unwritable.find("cannot be cached"), std::string::npos) << unwritable;
    EXPECT_EQ(contents(folder.path("d.png")), image);
}

/// A binary that the driver does not take is noted and the program built from its source.
TEST(CachedProgram, IsBuiltAnewWhereTheDriverRefusesIt) {
    const SceneFolder folder;
    const ChildResult result = run_program(fs::read_symlink("/proc/self/exe").string(),
                                           {"--gtest_also_run_disabled_tests", "--gtest_filter=*RefusedBinary"},
                                           {{"XDG_CACHE_HOME", folder.path("xdg")}, {"TRISTIM_PROGRAM_CACHE", "1"}});
    EXPECT_EQ(result.exit_code, 0) << result.standard_output;
    EXPECT_NE(result.standard_error.find("does not take the kernels cached for it"), std::string::npos)
        << result.standard_error;
}

/// Runs in the process of the test above, whose cache is of its own.
TEST(CachedProgram, DISABLED_RefusedBinary) {
    const Device& device = test_device();
    const std::string text = "kernel void set(global int* a) { a[0] = 42; }\n";
    const ::cl::Program built = build_program_from_text(device, "set.cl", text, {}, {});
    keep_program(device, built);
    fs::path file;
    for (const auto& entry : fs::directory_iterator(program_cache_folder()))
        file = entry.path();
    ASSERT_FALSE(file.empty());

    // The same key with a binary that is none: made by a cache in another folder under the key that the file holds.
    const std::string stored = contents(file);
    std::vector<std::string> fields;
    std::size_t at = stored.find('\n') + 1;
    for (int i = 0; i < 6; ++i) {
        std::size_t size = 0;
        for (std::size_t byte = 0; byte < 8; ++byte)
            size |= static_cast<std::size_t>(static_cast<unsigned char>(stored[at + byte])) << (8 * byte);
        fields.push_back(stored.substr(at + 8, size));
        at += 8 + size;
    }
    ProgramCache(program_cache_folder(), nullptr)
        .store({fields[0], fields[1], fields[2], fields[3], fields[4], fields[5]}, a_binary);

    const ::cl::Program rebuilt = build_program_from_text(device, "set.cl", text, {}, {});
    EXPECT_NO_THROW(::cl::Kernel(rebuilt, "set"));
}

/// Sets a variable of the environment, and puts it back as it was.
class Variable {
  public:
    Variable(const char* name, const char* value) : name_(name) {
        if (const char* old = std::getenv(name); old != nullptr)
            old_ = old;
        ::setenv(name, value, 1);
    }
    ~Variable() {
        if (old_)
            ::setenv(name_, old_->c_str(), 1);
        else
            ::unsetenv(name_);
    }
    Variable(const Variable&) = delete;
    Variable& operator=(const Variable&) = delete;

  private:
    const char* name_;
    std::optional<std::string> old_;
};

TEST(ProgramCacheFolder, FollowsTheXdgSpecification) {
    const auto folder_with = [](const char* xdg, const char* home, const char* cache) {
        const Variable a("XDG_CACHE_HOME", xdg);
        const Variable b("HOME", home);
        const Variable c("TRISTIM_PROGRAM_CACHE", cache);
        return program_cache_folder().string();
    };
    EXPECT_EQ(folder_with("/x", "/h", ""), "/x/tristim");
    EXPECT_EQ(folder_with("", "/h", ""), "/h/.cache/tristim");
    EXPECT_EQ(folder_with("relative", "/h", ""), "/h/.cache/tristim");
    EXPECT_EQ(folder_with("", "", ""), "");
    EXPECT_EQ(folder_with("/x", "/h", "0"), "");
}

} // namespace
} // namespace tristim::test
