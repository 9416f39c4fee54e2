#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace tristim::test {

/// How a child process ended and what it said.
struct ChildResult {
    int exit_code = -1; ///< 128 + the signal that ended it, as a shell says
    std::string standard_output;
    std::string standard_error;
};

/// What else a child gets.
struct ChildLimits {
    std::optional<rlim_t> file_size;                          ///< bytes; beyond them a write fails with EFBIG
    std::optional<rlim_t> memory;                             ///< bytes of address space
    std::optional<std::chrono::milliseconds> interrupt_after; ///< counted from its first line on stderr
    int interrupt_signal = SIGINT;
    std::optional<int> pending_signal = {}; ///< sent at the start, and held back until the program catches it
};

namespace child_detail {

inline std::string read_all(std::FILE* file) {
    std::string text;
    std::rewind(file);
    std::array<char, 4096> block{};
    for (std::size_t n = 0; (n = std::fread(block.data(), 1, block.size(), file)) > 0;)
        text.append(block.data(), n);
    return text;
}

inline void limit(int resource, const std::optional<rlim_t>& value) {
    if (!value)
        return;
    const rlimit both{*value, *value};
    ::setrlimit(static_cast<__rlimit_resource>(resource), &both);
}

} // namespace child_detail

/// Runs a program, given by its path, with arguments and extra environment variables, and waits for its end.
inline ChildResult run_program(const std::string& program, const std::vector<std::string>& arguments,
                               const std::map<std::string, std::string>& environment = {},
                               const ChildLimits& limits = {}) {
    std::FILE* out = std::tmpfile();
    std::FILE* err = std::tmpfile();
    std::vector<std::string> words{program};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words)
        argv.push_back(word.data());
    argv.push_back(nullptr);
    const ::pid_t child = ::fork();
    if (child == 0) {
        ::dup2(::fileno(out), STDOUT_FILENO);
        ::dup2(::fileno(err), STDERR_FILENO);
        for (const auto& [name, value] : environment)
            ::setenv(name.c_str(), value.c_str(), 1);
        if (limits.file_size)
            std::signal(SIGXFSZ, SIG_IGN); // ignored signals stay so in the new program
        if (limits.pending_signal) {
            ::sigset_t signals;
            sigemptyset(&signals);
            sigaddset(&signals, *limits.pending_signal);
            ::sigprocmask(SIG_BLOCK, &signals, nullptr);
            std::raise(*limits.pending_signal);
        }
        child_detail::limit(RLIMIT_FSIZE, limits.file_size);
        child_detail::limit(RLIMIT_AS, limits.memory);
        ::execv(program.c_str(), argv.data());
        std::_Exit(127);
    }
    int status = 0;
    if (limits.interrupt_after) {
        // Wait until it has said something, so that it is past its start.
        const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        while (::lseek(::fileno(err), 0, SEEK_END) == 0 && std::chrono::steady_clock::now() < deadline)
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        std::this_thread::sleep_for(*limits.interrupt_after);
        ::kill(child, limits.interrupt_signal);
    }
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    ChildResult result;
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    result.standard_output = child_detail::read_all(out);
    result.standard_error = child_detail::read_all(err);
    std::fclose(out);
    std::fclose(err);
    return result;
}

/// The same with the built tristim command.
inline ChildResult run_tristim(const std::vector<std::string>& arguments,
                               const std::map<std::string, std::string>& environment = {},
                               const ChildLimits& limits = {}) {
    return run_program(TRISTIM_COMMAND, arguments, environment, limits);
}

} // namespace tristim::test
