#pragma once

#include "opencl/device.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tristim {

/// What a program's binary depends on.
struct ProgramKey {
    std::string platform; ///< and its version
    std::string device;
    std::string driver;
    std::string environment; ///< variables that change what the compiler makes
    std::string options;     ///< as the compiler gets them
    std::string source;

    bool operator==(const ProgramKey&) const = default;
};

using ProgramBinary = std::vector<unsigned char>;

/// Binaries of programs in a folder, one file each, named by a hash of the key. Nothing that is wrong with the folder
/// or its files is an error: the first such thing becomes a note, and the program is built from its source.
/// Processes and threads may share a folder, since files are written under another name and renamed.
class ProgramCache {
  public:
    using Note = std::function<void(const std::string&)>;

    /// Bytes of all files together, beyond which the files that went unread the longest are removed.
    static constexpr std::uintmax_t usual_limit = std::uintmax_t{256} << 20U;

    /// A cache in this folder, which store() makes if need be. `note` gets one sentence, once.
    ProgramCache(std::filesystem::path folder, Note note, std::uintmax_t limit = usual_limit);

    /// The binary that was stored for this key. None if there is none, or its file is damaged or of another key.
    std::optional<ProgramBinary> load(const ProgramKey& key);

    void store(const ProgramKey& key, const ProgramBinary& binary);

    /// Gives the note, if it is the first.
    void tell(const std::string& what);

    std::filesystem::path file(const ProgramKey& key) const;

  private:
    void remove_oldest() const;

    std::filesystem::path folder_;
    Note note_;
    std::uintmax_t limit_;
};

/// $XDG_CACHE_HOME/tristim, or ~/.cache/tristim; empty if there is neither, or TRISTIM_PROGRAM_CACHE is 0.
std::filesystem::path program_cache_folder();

/// The program as this process's cache in program_cache_folder() has it, ready for kernels; none if it does not.
std::optional<::cl::Program> cached_program(const Device& device, const std::string& source,
                                            const std::string& options);

/// Puts a program that was built from source into the cache, and does nothing with others.
void keep_program(const Device& device, const ::cl::Program& program);

/// Whether keep_program() takes next to no time, so that every program may be kept as soon as it is built.
///
/// What it is worth, in seconds of processor time for the six programs of meshes/dispersion, and what a start then
/// takes (bench/starts measures the latter again):
///
///                       from source  binaries taken  from binaries
///     Intel's (2026.2)          3.9            0.00           0.04
///     Mesa's rusticl (22.3)     0.5            0.00           0.10  (llvmpipe compiles at first launches, tens of
///                                                                   seconds; Mesa caches that by itself)
///     Oclgrind (21.10)          0.35           0.03           0.02
///     PoCL (3.1)                1.4            1.5            0.02  (0.2 from source that PoCL has cached, all of it
///                                                                   for its preprocessor)
///
/// PoCL compiles every kernel once more for its binaries, for any work-group size, unlike those that it launches.
bool is_cheap_to_keep(const DeviceInfo& device);

} // namespace tristim
