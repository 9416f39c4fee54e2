#include "image/output_file.h"

#include "base/error.h"
#include "base/parse_number.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <random>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace tristim {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_to_write(const std::string& path, const std::string& reason) {
    fail("cannot write \"{}\": {}", path, reason);
}

fs::path folder_of(const fs::path& file) {
    return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// Where the bytes go: what symbolic links lead to, be it there or not, or the path itself.
fs::path final_path(const std::string& path) {
    constexpr int most_links = 40; // as Linux follows
    fs::path target = path;
    std::error_code error;
    for (int links = 0; fs::is_symlink(target, error); ++links) {
        if (links == most_links)
            fail_to_write(path, "too many levels of symbolic links");
        target = folder_of(target) / fs::read_symlink(target, error); // an absolute one replaces the folder
    }
    return target;
}

/// Of temporary files' names, a number follows.
std::string temporary_prefix(const fs::path& target) {
    return fmt::format(".{}.tmp", target.filename().string());
}

/// Whether a process has this temporary file open; where the file system knows no locks, it cannot be told.
bool is_being_written(const fs::path& temporary_file) {
    const int descriptor = ::open(temporary_file.c_str(), O_RDWR | O_NOFOLLOW | O_CLOEXEC);
    if (descriptor < 0)
        return false;
    const bool locked = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    ::close(descriptor);
    return locked;
}

/// Makes a renaming in it last. Not all file systems can, which is no reason to call a file that stands there lost.
void flush_folder(const fs::path& folder) {
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0)
        return;
    static_cast<void>(::fsync(descriptor));
    ::close(descriptor);
}

/// An open temporary file beside the target, removed unless it has replaced it.
class TemporaryFile {
  public:
    TemporaryFile(const fs::path& target, std::string user_path)
        : user_path_(std::move(user_path)), target_(target),
          // A process's number would not do: other machines and containers that write to the folder have it too.
          name_(folder_of(target) / fmt::format("{}{}", temporary_prefix(target), std::random_device()())),
          descriptor_(::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666)) {
        if (descriptor_ < 0)
            fail_to_write(user_path_, std::strerror(errno));
        static_cast<void>(::flock(descriptor_, LOCK_EX)); // until the file is closed: for remove_leftovers of others
    }

    ~TemporaryFile() {
        close();
        if (!renamed_)
            ::unlink(name_.c_str());
    }

    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    void write(std::span<const unsigned char> bytes) {
        while (!bytes.empty()) {
            const ::ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
            if (count < 0 && errno != EINTR)
                fail_to_write(user_path_, std::strerror(errno));
            if (count > 0)
                bytes = bytes.subspan(static_cast<std::size_t>(count));
        }
    }

    void replace_target() {
        keep_permissions();
        if (::fsync(descriptor_) != 0 || close() != 0 || std::rename(name_.c_str(), target_.c_str()) != 0)
            fail_to_write(user_path_, std::strerror(errno));
        renamed_ = true;
        flush_folder(folder_of(target_));
    }

  private:
    /// Those of the file that is replaced. A file system that knows no permissions is no reason to lose the data.
    void keep_permissions() {
        struct stat existing {};
        if (::stat(target_.c_str(), &existing) == 0)
            static_cast<void>(::fchmod(descriptor_, existing.st_mode & 07777));
    }

    int close() {
        const int result = descriptor_ >= 0 ? ::close(descriptor_) : 0;
        descriptor_ = -1;
        return result;
    }

    std::string user_path_;
    fs::path target_;
    fs::path name_;
    int descriptor_ = -1;
    bool renamed_ = false;
};

/// What can be told without an attempt, in words that say more than an error code.
void check_place(const std::string& path) {
    const fs::path target = final_path(path);
    const fs::path folder = folder_of(target);
    std::error_code ignored;
    if (target.empty() || !target.has_filename())
        fail_to_write(path, "it names no file");
    if (!fs::exists(folder, ignored))
        fail_to_write(path, fmt::format("the folder \"{}\" does not exist", folder.string()));
    if (!fs::is_directory(folder, ignored))
        fail_to_write(path, fmt::format("\"{}\" is not a folder", folder.string()));
    if (fs::is_directory(target, ignored))
        fail_to_write(path, "it is a folder");
    if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored))
        fail_to_write(path, "it is not a regular file");
    if (::access(folder.c_str(), W_OK | X_OK) != 0)
        fail_to_write(path,
                      fmt::format("the folder \"{}\" is not writable ({})", folder.string(), std::strerror(errno)));
    if (fs::exists(target, ignored) && ::access(target.c_str(), W_OK) != 0)
        fail_to_write(path, std::strerror(errno));
}

} // namespace

void check_output_file(const std::string& path) {
    check_place(path);
    // Other reasons show only in an attempt: /proc, names too long for the temporary file, no inodes left, …
    const TemporaryFile attempt(final_path(path), path);
}

bool is_same_file(const std::string& a, const std::string& b) {
    const auto place = [](const std::string& path) {
        std::error_code ignored;
        const fs::path target = final_path(path);
        return fs::weakly_canonical(folder_of(target), ignored) / target.filename();
    };
    std::error_code ignored;
    return a == b || fs::equivalent(a, b, ignored) || (!a.empty() && !b.empty() && place(a) == place(b));
}

void replace_file(const std::string& path, std::span<const unsigned char> bytes) {
    check_place(path);
    TemporaryFile file(final_path(path), path);
    file.write(bytes);
    file.replace_target();
}

void remove_leftovers(const std::string& path) {
    const fs::path target = final_path(path);
    const std::string prefix = temporary_prefix(target);
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_of(target), ignored)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with(prefix) && parse_number<std::uint32_t>(std::string_view(name).substr(prefix.size())) &&
            !is_being_written(entry.path()))
            fs::remove(entry.path(), ignored);
    }
}

void make_folder(const std::string& path) {
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (error)
        fail("cannot make the folder \"{}\": {}", path, error.message());
}

void replace_file(const std::string& path, std::string_view text) {
    replace_file(path, std::span(reinterpret_cast<const unsigned char*>(text.data()), text.size()));
}

} // namespace tristim
