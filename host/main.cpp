#include "base/error.h"
#include "base/tell.h"
#include "commands/bench.h"
#include "commands/bench_film.h"
#include "commands/bench_pass.h"
#include "commands/bench_rays.h"
#include "commands/bench_reduce.h"
#include "commands/bench_wavelengths.h"
#include "commands/compare.h"
#include "commands/devices.h"
#include "commands/effects.h"
#include "commands/film.h"
#include "commands/merge.h"
#include "commands/methods.h"
#include "commands/reference.h"
#include "commands/render.h"
#include "commands/report.h"
#include "commands/selftest.h"
#include "commands/spectra.h"
#include "mpi/agree.h"
#include "opencl/errors.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <csignal>
#include <fcntl.h>
#include <new>
#include <span>
#include <string>
#include <system_error>
#include <unistd.h>

namespace {

constexpr int exit_failure = 1;
constexpr int exit_usage = 2;

/// Opens those of the standard streams that are closed: else the next file that is written would take the place of
/// stderr, and messages would go into it.
void open_standard_streams() {
    int descriptor = 0;
    do
        descriptor = ::open("/dev/null", O_RDWR);
    while (descriptor >= 0 && descriptor <= STDERR_FILENO);
    if (descriptor >= 0)
        ::close(descriptor);
}

/// What was typed, for a shell to repeat.
std::string command_line(int argc, char** argv) {
    std::string line = "tristim";
    for (const std::string word : std::span(argv + 1, argv + std::max(argc, 1))) {
        const bool plain =
            !word.empty() && word.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                                    "0123456789_-+=:,./@%") == std::string::npos;
        std::string quoted = word;
        for (std::size_t at = 0; (at = quoted.find('\'', at)) != std::string::npos; at += 4)
            quoted.replace(at, 1, "'\\''");
        line += plain ? " " + word : " '" + quoted + "'";
    }
    return line;
}

int run(int argc, char** argv) {
    CLI::App app{"tristim: a spectral photon mapper on OpenCL"};
    app.name("tristim");
    app.set_version_flag("--version", TRISTIM_VERSION);
    app.require_subcommand(1);
    app.get_formatter()->column_width(36);
    tristim::add_render_command(app);
    tristim::add_merge_command(app);
    tristim::add_reference_command(app);
    tristim::add_effects_command(app);
    tristim::add_methods_command(app);
    tristim::add_devices_command(app);
    tristim::add_selftest_command(app);
    tristim::add_compare_command(app);
    tristim::add_film_command(app);
    tristim::add_spectra_command(app);
    tristim::add_bench_command(app, command_line(argc, argv));
    tristim::add_report_command(app);
    tristim::add_bench_rays_command(app);
    tristim::add_bench_pass_command(app);
    tristim::add_bench_film_command(app);
    tristim::add_bench_reduce_command(app);
    tristim::add_bench_wavelengths_command(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::RuntimeError& error) {
        return error.get_exit_code(); // a command's own
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0)
            return app.exit(error); // --help, --version
        const auto chosen = app.get_subcommands();
        try {
            // Other ranks may have been started with other arguments: it is their first step, too, that all agree upon.
            tristim::at_all_ranks(tristim::join_ranks(), [&] {
                tristim::fail("{} (see 'tristim {}--help')", error.what(),
                              chosen.empty() ? "" : chosen.front()->get_name() + " ");
            });
        } catch (const tristim::Error& all) {
            tristim::tell("tristim: {}\n", all.what());
        } catch (const tristim::EndedElsewhere&) {
        }
        return exit_usage;
    }
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    open_standard_streams();
    std::signal(SIGXFSZ, SIG_IGN); // a limit on the size of files makes writing fail instead
    std::string problem;
    try {
        return run(argc, argv);
    } catch (const tristim::EndedElsewhere& end) {
        return end.exit_code;
    } catch (const tristim::Error&) {
        problem = tristim::describe_current_exception();
    } catch (const ::cl::Error&) {
        problem = tristim::describe_current_exception();
    } catch (const std::bad_alloc&) {
        problem = tristim::describe_current_exception();
    } catch (const std::system_error&) { // such as of fmt::print
        problem = tristim::describe_current_exception();
    }
    tristim::Communicator* const ranks = tristim::joined_ranks();
    tristim::tell("tristim: {}{}\n", ranks != nullptr ? fmt::format("rank {}: ", ranks->rank()) : "", problem);
    if (ranks != nullptr)
        ranks->abort(exit_failure); // the others wait for this one
    return exit_failure;
}
