#include "opencl/program.h"

#include "base/embedded_files.h"
#include "base/error.h"
#include "opencl/errors.h"

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string_view>

namespace tristim {
namespace {

std::string_view embedded_kernel(const std::string& file) {
    const auto found = embedded_files().find("kernels/" + file);
    if (found == embedded_files().end())
        fail("kernel source '{}' is not part of this binary", file);
    return found->second;
}

void append_flattened(const std::string& file, std::string_view text, std::set<std::string>& seen, std::string& out) {
    std::istringstream lines{std::string(text)};
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
                append_flattened(included, embedded_kernel(included), seen, out);
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

void dump(const std::string& kernel_file, const std::string& source, const Macros& macros,
          const BuildOptions& options) {
    std::error_code ignored; // an unusable folder shows up when the file is written
    std::filesystem::create_directories(options.dump_dir, ignored);
    const std::filesystem::path path = std::filesystem::path(options.dump_dir) / kernel_file;
    std::ofstream file(path);
    file << "// Options: " << compiler_options(macros, options) << "\n";
    if (options.fast_math)
        file << "#define FAST_MATH 1\n";
    for (const auto& [name, value] : macros)
        file << "#define " << name << " " << value << "\n";
    file << source;
    file.close();
    if (!file)
        fail("cannot write kernel source to '{}'", path.string());
}

} // namespace

std::string flatten_kernel_source(const std::string& kernel_file) {
    std::set<std::string> seen{kernel_file};
    std::string source;
    append_flattened(kernel_file, embedded_kernel(kernel_file), seen, source);
    return source;
}

::cl::Program build_program(const Device& device, const std::string& kernel_file, const Macros& macros,
                            const BuildOptions& options) {
    return build_program_from_text(device, kernel_file, std::string(embedded_kernel(kernel_file)), macros, options);
}

::cl::Program build_program_from_text(const Device& device, const std::string& name, const std::string& text,
                                      const Macros& macros, const BuildOptions& options) {
    std::set<std::string> seen{name};
    std::string source;
    append_flattened(name, text, seen, source);
    if (!options.dump_dir.empty())
        dump(name, source, macros, options);
    ::cl::Program program(device.context, source);
    try {
        program.build(device.device, compiler_options(macros, options).c_str());
    } catch (const ::cl::Error& error) {
        fail("kernel '{}' does not build on '{}' ({}):\n{}", name, device.info.name, opencl_error_name(error.err()),
             program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device.device));
    }
    return program;
}

} // namespace tristim
