#include "commands/report.h"

#include "base/tell.h"
#include "report/report.h"

#include <fmt/format.h>
#include <memory>
#include <string>

namespace tristim {

void add_report_command(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("report", "Draw a bench's table, plots and report.html again from its results.json");
    const auto folder = std::make_shared<std::string>();
    command->add_option("folder", *folder, "Folder that `tristim bench --out` wrote")->required()->type_name("DIR");
    command->callback([folder] {
        const std::vector<std::string> missing = write_report(*folder);
        if (!missing.empty())
            tell("note: {} images are missing and left out, the first is {}\n", missing.size(), missing.front());
        fmt::print("wrote results.csv, plots and report.html in {}\n", *folder);
    });
}

} // namespace tristim
