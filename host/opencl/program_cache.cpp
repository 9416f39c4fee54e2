#include "opencl/program_cache.h"

#include "base/hash.h"
#include "base/tell.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <mutex>
#include <set>
#include <string_view>
#include <unistd.h>

namespace tristim {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view magic = "tristim program 1\n";

std::string bytes_of(std::uint64_t value) {
    std::string bytes(8, '\0');
    for (std::size_t i = 0; i < bytes.size(); ++i)
        bytes[i] = static_cast<char>(value >> (8 * i) & 0xffU);
    return bytes;
}

/// The fields one after the other, each with its length in front, so that no two keys read alike.
std::string to_bytes(const ProgramKey& key) {
    std::string bytes;
    for (const std::string* field :
         {&key.platform, &key.device, &key.driver, &key.environment, &key.options, &key.source})
        bytes += bytes_of(field->size()) + *field;
    return bytes;
}

std::string_view view(const ProgramBinary& binary) {
    return {reinterpret_cast<const char*>(binary.data()), binary.size()};
}

/// All that comes before the binary: the key is there whole, so that a file of another key is told for certain.
std::string header(const ProgramKey& key, std::uint64_t binary_size) {
    return std::string(magic) + to_bytes(key) + bytes_of(binary_size);
}

std::string checksum(std::string_view head, std::string_view binary) {
    Hash hash;
    hash.add_bytes(head);
    hash.add_bytes(binary);
    return bytes_of(hash.value());
}

/// A name beside `target` that no other process or thread writes to.
fs::path temporary_name(const fs::path& target) {
    static std::atomic<unsigned> count{0};
    return target.parent_path() / fmt::format("{}.tmp{}-{}", target.stem().string(), ::getpid(), ++count);
}

const char* environment(const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr ? value : "";
}

} // namespace

ProgramCache::ProgramCache(fs::path folder, Note note, std::uintmax_t limit)
    : folder_(std::move(folder)), note_(std::move(note)), limit_(limit) {}

void ProgramCache::tell(const std::string& what) {
    static std::mutex mutex;
    const std::lock_guard lock(mutex);
    if (note_)
        note_(what);
    note_ = nullptr;
}

fs::path ProgramCache::file(const ProgramKey& key) const {
    Hash name;
    name.add_bytes(to_bytes(key));
    return folder_ / (name.hexadecimal() + ".bin");
}

std::optional<ProgramBinary> ProgramCache::load(const ProgramKey& key) {
    const fs::path path = file(key);
    std::error_code error;
    if (!fs::exists(path, error))
        return std::nullopt; // an unusable folder is told when it is to be written
    std::ifstream stream(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    const auto refuse = [&](const char* reason) {
        tell(fmt::format("the kernels cached in '{}' are not used and built anew: {}", path.string(), reason));
        return std::nullopt;
    };
    if (!stream || text.empty())
        return refuse("the file cannot be read");
    if (text.rfind(magic, 0) != 0)
        return refuse("the file is not of this version of tristim");
    const std::size_t head_size = header(key, 0).size();
    constexpr std::size_t checksum_size = 8;
    if (text.size() < head_size + checksum_size)
        return refuse("the file is damaged");
    const std::string_view content(text);
    const std::string_view binary = content.substr(head_size, content.size() - head_size - checksum_size);
    const std::string_view head = content.substr(0, head_size);
    if (checksum(head, binary) != content.substr(content.size() - checksum_size))
        return refuse("the file is damaged");
    if (header(key, binary.size()) != head)
        return refuse("the file is of another program");
    fs::last_write_time(path, fs::file_time_type::clock::now(), error);
    return ProgramBinary(binary.begin(), binary.end());
}

void ProgramCache::store(const ProgramKey& key, const ProgramBinary& binary) {
    std::error_code error;
    if (fs::create_directories(folder_, error))
        fs::permissions(folder_, fs::perms::owner_all, error);
    const fs::path path = file(key);
    const fs::path temporary = temporary_name(path);
    const std::string head = header(key, binary.size());
    std::ofstream stream(temporary, std::ios::binary);
    stream << head << view(binary) << checksum(head, view(binary));
    stream.close();
    if (stream)
        fs::rename(temporary, path, error);
    if (!stream || error) {
        tell(fmt::format("kernels cannot be cached in '{}' and will be built anew each time", folder_.string()));
        fs::remove(temporary, error);
        return;
    }
    remove_oldest();
}

void ProgramCache::remove_oldest() const {
    struct File {
        fs::file_time_type read;
        std::uintmax_t size;
        fs::path path;
    };
    std::vector<File> files;
    std::uintmax_t total = 0;
    std::error_code error; // another process may be removing files too
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_, error)) {
        const std::uintmax_t size = entry.file_size(error);
        if (error)
            continue;
        files.push_back({entry.last_write_time(error), size, entry.path()});
        total += size;
    }
    std::sort(files.begin(), files.end(), [](const File& a, const File& b) { return a.read < b.read; });
    for (auto oldest = files.begin(); total > limit_ && oldest != files.end(); ++oldest) {
        fs::remove(oldest->path, error);
        total -= oldest->size;
    }
}

fs::path program_cache_folder() {
    if (std::string_view(environment("TRISTIM_PROGRAM_CACHE")) == "0")
        return {};
    // The XDG Base Directory Specification: a relative path is invalid and to be ignored.
    if (const fs::path cache = environment("XDG_CACHE_HOME"); cache.is_absolute())
        return cache / "tristim";
    if (const fs::path home = environment("HOME"); home.is_absolute())
        return home / ".cache" / "tristim";
    return {};
}

namespace {

ProgramCache& process_cache() {
    static ProgramCache cache(program_cache_folder(), [](const std::string& what) { tell("note: {}\n", what); });
    return cache;
}

/// Variables that change what compilers of the platforms in README make, "NAME=value" each.
std::string compiler_environment() {
    std::set<std::string> variables;
    for (char** entry = environ; *entry != nullptr; ++entry) {
        const std::string_view variable(*entry);
        const auto begins = [&](std::string_view prefix) { return variable.substr(0, prefix.size()) == prefix; };
        if (begins("POCL_CACHE_DIR="))
            continue;
        if (begins("POCL_") || begins("LP_") || begins("GALLIVM_") || begins("CL_CONFIG_"))
            variables.emplace(variable);
    }
    return fmt::format("{}", fmt::join(variables, " "));
}

ProgramKey key_of(const Device& device, const std::string& source, const std::string& options) {
    const ::cl::Platform platform(device.device.getInfo<CL_DEVICE_PLATFORM>());
    return {device.info.platform + ", " + platform.getInfo<CL_PLATFORM_VERSION>(),
            device.info.name,
            device.info.driver,
            compiler_environment(),
            options,
            source};
}

} // namespace

std::optional<::cl::Program> cached_program(const Device& device, const std::string& source,
                                            const std::string& options) {
    if (program_cache_folder().empty())
        return std::nullopt;
    const std::optional<ProgramBinary> binary = process_cache().load(key_of(device, source, options));
    if (!binary)
        return std::nullopt;
    try {
        ::cl::Program program(device.context, {device.device}, ::cl::Program::Binaries{*binary});
        program.build(device.device);
        return program;
    } catch (const ::cl::Error&) {
        process_cache().tell(
            fmt::format("'{}' does not take the kernels cached for it: they are built anew", device.info.name));
        return std::nullopt;
    }
}

void keep_program(const Device& device, const ::cl::Program& program) {
    if (program_cache_folder().empty())
        return;
    try {
        const std::string source = program.getInfo<CL_PROGRAM_SOURCE>();
        const std::vector<ProgramBinary> binaries = program.getInfo<CL_PROGRAM_BINARIES>();
        if (!source.empty() && binaries.size() == 1 && !binaries.front().empty())
            process_cache().store(key_of(device, source, program.getBuildInfo<CL_PROGRAM_BUILD_OPTIONS>(device.device)),
                                  binaries.front());
    } catch (const ::cl::Error&) {
        process_cache().tell(fmt::format("'{}' does not give its kernels to be cached: they are built anew each time",
                                         device.info.name));
    }
}

bool is_cheap_to_keep(const DeviceInfo& device) {
    return device.platform != "Portable Computing Language";
}

} // namespace tristim
