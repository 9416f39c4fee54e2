#pragma once

#include "opencl/device.h"

#include <string>
#include <utility>
#include <vector>

namespace tristim {

/// Macros for one program, in order: {"W", "3"} becomes -D W=3.
using Macros = std::vector<std::pair<std::string, std::string>>;

/// How programs are built.
struct BuildOptions {
    bool fast_math = false;      ///< -cl-fast-relaxed-math and native_* functions
    std::string dump_dir;        ///< if set, the exact source that ran is written there, its options as #defines on top
    std::string source_dir = {}; ///< if set, kernel files and headers are read from there, not from the binary
};

/// The source of a kernel file ("eye_pass.cl") with its includes put in place, each once.
std::string flatten_kernel_source(const std::string& kernel_file);

/// A hash of all kernel files and headers but those of selftest, as they are in the binary or, where there are any, in
/// a folder: 16 hexadecimal digits.
std::string hash_kernel_sources(const std::string& source_dir);

/// Builds one kernel file for a device. Throws Error with the build log if it does not compile.
::cl::Program build_program(const Device& device, const std::string& kernel_file, const Macros& macros,
                            const BuildOptions& options);

/// The same for source text that is no kernel file itself but may #include kernel files and headers, such as a test's;
/// `name` is for messages and for the dumped file.
::cl::Program build_program_from_text(const Device& device, const std::string& name, const std::string& text,
                                      const Macros& macros, const BuildOptions& options);

} // namespace tristim
