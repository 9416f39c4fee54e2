#include "commands/methods.h"

#include "render/method.h"

#include <fmt/core.h>

namespace tristim {
namespace {

void list_methods() {
    constexpr const char* line = "{:<22}{:<10}{:<10}{}\n";
    fmt::print(line, "method", "W", "exact", "how the W wavelengths of a pass are chosen");
    for (const MethodKind& kind : method_kinds()) {
        const std::string count = kind.count_name == nullptr ? "" : kind.count_name;
        const bool fixed = kind.least == kind.most;
        std::string w = fixed ? std::to_string(kind.most * kind.wavelengths) : count;
        if (kind.wavelengths != 1)
            w = fmt::format("{} {}", kind.wavelengths, count);
        const std::string range = fixed ? "" : fmt::format("; {} from {} to {}", count, kind.least, kind.most);
        fmt::print(line, pattern(kind), w, kind.unbiased ? "yes" : "biased",
                   fmt::format("{}{} ({})", kind.summary, range, kind.source));
    }
    fmt::print(line, "auto", "", "yes",
               "illuminant-mixture, with the C that a few passes of several find best for the scene");
    fmt::print("With --sequence stratified wavelengths are spread within a pass and over the passes, with random they "
               "are drawn "
               "afresh as in the paper; those of rgb and gauss are fixed. Exact: "
               "passes average to the XYZ of every spectrum.\n");
}

} // namespace

void add_methods_command(CLI::App& app) {
    app.add_subcommand("methods", "List the methods of choosing wavelengths that --method takes")
        ->callback(list_methods);
}

} // namespace tristim
