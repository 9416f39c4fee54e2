#include "plot/python.h"

#include "base/embedded_files.h"
#include "base/error.h"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace tristim {
namespace {

constexpr int no_matplotlib = 3; // exit status of host/plot/style.py

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

struct ScriptRun {
    bool started = false;
    int exit_status = -1; ///< 128 + signal if one ended it
    std::string output;
    std::string messages; ///< standard error
};

/// Runs the script by one Python, no shell in between.
ScriptRun run(const std::string& python, const std::string& script, const std::string& text) {
    ScratchFile input, output, messages;
    input.write(text);
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

} // namespace

std::string run_python(std::span<const std::string_view> files, const std::string& input, const std::string& task) {
    std::string script;
    for (const std::string_view file : files)
        script.append(embedded_files().at(std::string(file)));
    bool any_python = false;
    for (const std::string& python : pythons()) {
        ScriptRun result = run(python, script, input);
        const bool missing = !result.started || result.exit_status == 127; // 127: what a child says that cannot exec
        any_python = any_python || !missing;
        if (missing || result.exit_status == no_matplotlib)
            continue;
        if (result.exit_status != 0)
            fail("cannot {}: {} failed with status {} ({})", task, python, result.exit_status,
                 last_line(result.messages));
        return std::move(result.output);
    }
    fail("cannot {}: {} (Debian: apt install python3-matplotlib)", task,
         any_python ? "Python has no matplotlib" : "there is no Python 3");
}

} // namespace tristim
