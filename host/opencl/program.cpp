#include "opencl/program.h"

#include "base/embedded_files.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/read_file.h"
#include "opencl/errors.h"
#include "opencl/program_cache.h"

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string_view>

namespace tristim {
namespace {

std::string kernel_text(const std::string& file, const std::string& source_dir) {
    if (!source_dir.empty())
        return read_whole_file((std::filesystem::path(source_dir) / file).string());
    const auto found = embedded_files().find("kernels/" + file);
    if (found == embedded_files().end())
        fail("kernel source '{}' is not part of this binary", file);
    return std::string(found->second);
}

void append_flattened(const std::string& file, const std::string& text, const std::string& source_dir,
                      std::set<std::string>& seen, std::string& out) {
    std::istringstream lines{text};
    std::string line;
    int number = 0;
    out += fmt::format("#line 1 \"{}\"\n", file);
    while (std::getline(lines, line)) {
        ++number;
        const std::string directive = "#include \"";
        if (line.rfind(directive, 0) == 0) {
            const std::string included =
                line.substr(directive.size(), line.find('"', directive.size()) - directive.size());
            if (seen.insert(included).second)
                append_flattened(included, kernel_text(included, source_dir), source_dir, seen, out);
            out += fmt::format("#line {} \"{}\"\n", number + 1, file);
        } else {
            out += line + "\n";
        }
    }
}

std::string compiler_options(const Macros& macros, const BuildOptions& options) {
    std::string text = "-cl-std=CL1.2";
    if (options.fast_math)
        text += " -cl-fast-relaxed-math -D FAST_MATH=1";
    for (const auto& [name, value] : macros)
        text += fmt::format(" -D {}={}", name, value);
    return text;
}

/// How a dumped program begins; its options follow.
constexpr std::string_view dumped_options = "// Options: ";

/// A dumped program holds its options as #defines: under others it would go wrong without a word.
void check_dumped_options(const std::string& name, const std::string& text, const std::string& arguments) {
    if (text.starts_with(dumped_options) && text.substr(0, text.find('\n')) != std::string(dumped_options) + arguments)
        fail("kernel '{}' was dumped with other options than these: {}", name, arguments);
}

void dump(const std::string& kernel_file, const std::string& source, const Macros& macros,
          const BuildOptions& options) {
    std::error_code ignored; // an unusable folder shows up when the file is written
    std::filesystem::create_directories(options.dump_dir, ignored);
    const std::filesystem::path path = std::filesystem::path(options.dump_dir) / kernel_file;
    std::ofstream file(path);
    file << dumped_options << compiler_options(macros, options) << "\n";
    if (options.fast_math)
        file << "#define FAST_MATH 1\n";
    for (const auto& [name, value] : macros)
        file << "#define " << name << " " << value << "\n";
    file << source;
    file.close();
    if (!file)
        fail("cannot write kernel source to '{}'", path.string());
}

/// What the compiler said, on lines of its own; empty if there is nothing to tell.
std::string build_log(const ::cl::Program& program, const ::cl::Device& device) {
    try {
        const std::string log = program() != nullptr ? program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device) : "";
        return log.find_first_not_of(" \n\t") == std::string::npos ? "" : ":\n" + log;
    } catch (const ::cl::Error&) {
        return ""; // a device that is lost has no log either
    }
}

} // namespace

std::string flatten_kernel_source(const std::string& kernel_file) {
    std::set<std::string> seen{kernel_file};
    std::string source;
    append_flattened(kernel_file, kernel_text(kernel_file, ""), "", seen, source);
    return source;
}

std::string hash_kernel_sources(const std::string& source_dir) {
    constexpr std::string_view folder = "kernels/";
    Hash hash;
    for (const auto& [path, text] : embedded_files()) {
        if (!path.starts_with(folder) || path.starts_with("kernels/selftest/"))
            continue;
        const std::string file = path.substr(folder.size());
        if (!source_dir.empty() && !std::filesystem::exists(std::filesystem::path(source_dir) / file))
            continue; // of dumped programs there are no headers
        hash.add(std::string_view(path));
        hash.add(std::string_view(kernel_text(file, source_dir)));
    }
    return hash.hexadecimal();
}

::cl::Program build_program(const Device& device, const std::string& kernel_file, const Macros& macros,
                            const BuildOptions& options) {
    return build_program_from_text(device, kernel_file, kernel_text(kernel_file, options.source_dir), macros, options);
}

::cl::Program build_program_from_text(const Device& device, const std::string& name, const std::string& text,
                                      const Macros& requested, const BuildOptions& options) {
    Macros macros = requested;
    if (!device.info.fma)
        macros.emplace_back("HAS_FMA", "0");
    std::set<std::string> seen{name};
    std::string source;
    append_flattened(name, text, options.source_dir, seen, source);
    if (!options.dump_dir.empty())
        dump(name, source, macros, options);
    const std::string arguments = compiler_options(macros, options);
    check_dumped_options(name, text, arguments);
    ::cl::Program program;
    try {
        device.before(DeviceCall::Build);
        if (const std::optional<::cl::Program> cached = cached_program(device, source, arguments))
            return *cached;
        program = ::cl::Program(device.context, source);
        program.build(device.device, arguments.c_str());
    } catch (const ::cl::Error& error) {
        fail("kernel '{}' does not build on '{}' ({}){}", name, device.info.name, opencl_error_name(error.err()),
             build_log(program, device.device));
    }
    if (is_cheap_to_keep(device.info))
        keep_program(device, program);
    return program;
}

} // namespace tristim
