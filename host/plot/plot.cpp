#include "plot/plot.h"

#include "base/embedded_files.h"
#include "base/error.h"
#include "image/output_file.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tristim {
namespace {

constexpr int no_matplotlib = 3; // exit status of plot.py

/// A nameless temporary file: a child's standard input or output, which unlike a pipe cannot fill up.
class ScratchFile {
  public:
    ScratchFile() : file_(std::tmpfile(), &std::fclose) {
        if (!file_)
            fail("cannot make a temporary file for the plot: {}", std::strerror(errno));
    }

    int descriptor() const { return ::fileno(file_.get()); }

    void write(const std::string& text) {
        if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size() || std::fflush(file_.get()) != 0)
            fail("cannot write a temporary file for the plot: {}", std::strerror(errno));
        std::rewind(file_.get());
    }

    std::string read() {
        std::rewind(file_.get());
        std::string text;
        std::array<char, 65536> block{};
        for (std::size_t n = 0; (n = std::fread(block.data(), 1, block.size(), file_.get())) > 0;)
            text.append(block.data(), n);
        return text;
    }

  private:
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
};

struct Drawing {
    bool started = false;
    int exit_status = -1; ///< 128 + signal if one ended it
    std::string png;
    std::string messages; ///< standard error
};

/// Runs the script by one Python, no shell in between.
Drawing draw(const std::string& python, const std::string& script, const std::string& json) {
    ScratchFile input, output, messages;
    input.write(json);
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_adddup2(&actions, input.descriptor(), STDIN_FILENO);
    ::posix_spawn_file_actions_adddup2(&actions, output.descriptor(), STDOUT_FILENO);
    ::posix_spawn_file_actions_adddup2(&actions, messages.descriptor(), STDERR_FILENO);
    std::array<std::string, 3> words{python, "-c", script};
    std::array<char*, 4> arguments{words[0].data(), words[1].data(), words[2].data(), nullptr};
    ::pid_t child = -1;
    const int error = ::posix_spawnp(&child, python.c_str(), &actions, nullptr, arguments.data(), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    if (error != 0)
        return {};
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return {true, WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), output.read(), messages.read()};
}

std::vector<std::string> pythons() {
    const char* chosen = std::getenv("TRISTIM_PYTHON");
    if (chosen != nullptr && *chosen != '\0')
        return {chosen};
    // The first python3 of the path may be one without Debian's packages.
    return {"python3", "/usr/bin/python3"};
}

std::string last_line(std::string text) {
    while (!text.empty() && text.back() == '\n')
        text.pop_back();
    return text.substr(text.rfind('\n') + 1); // npos + 1 is 0
}

std::string to_json(const Plot& plot) {
    nlohmann::json series = nlohmann::json::array();
    for (const PlotSeries& curve : plot.series) {
        if (curve.x.size() != curve.y.size())
            fail("the curve \"{}\" of a plot has {} positions but {} values", curve.label, curve.x.size(),
                 curve.y.size());
        series.push_back({{"label", curve.label}, {"x", curve.x}, {"y", curve.y}});
    }
    const nlohmann::json object{{"title", plot.title}, {"x_label", plot.x_label}, {"y_label", plot.y_label},
                                {"series", series},    {"strip", plot.strip},     {"strip_label", plot.strip_label}};
    return object.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

} // namespace

void check_plot_file(const std::string& png_path) {
    if (!png_path.ends_with(".png"))
        fail("the plot \"{}\" must be a .png file", png_path);
    check_output_file(png_path);
}

void write_plot(const Plot& plot, const std::string& png_path) {
    check_plot_file(png_path);
    const std::string json = to_json(plot);
    const std::string script(embedded_files().at("host/plot/plot.py"));
    bool any_python = false;
    for (const std::string& python : pythons()) {
        const Drawing drawing = draw(python, script, json);
        const bool missing = !drawing.started || drawing.exit_status == 127; // 127: what a child says that cannot exec
        any_python = any_python || !missing;
        if (missing || drawing.exit_status == no_matplotlib)
            continue;
        if (drawing.exit_status != 0)
            fail("cannot draw the plot \"{}\": {} failed with status {} ({})", png_path, python, drawing.exit_status,
                 last_line(drawing.messages));
        replace_file(png_path,
                     std::span(reinterpret_cast<const unsigned char*>(drawing.png.data()), drawing.png.size()));
        return;
    }
    fail("cannot draw the plot \"{}\": {} (Debian: apt install python3-matplotlib)", png_path,
         any_python ? "Python has no matplotlib" : "there is no Python 3");
}

} // namespace tristim
