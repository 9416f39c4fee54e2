#include "base/error.h"
#include "base/stopwatch.h"
#include "commands/device_check.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tristim {
namespace {

/// As posix_spawn() takes them.
std::vector<char*> pointers(std::vector<std::string>& texts) {
    std::vector<char*> pointers;
    for (std::string& text : texts)
        pointers.push_back(text.data());
    pointers.push_back(nullptr);
    return pointers;
}

/// A running program whose standard output can be read.
class Child {
  public:
    Child(std::vector<std::string> command, std::vector<std::string> environment) {
        std::array<int, 2> ends{};
        if (::pipe(ends.data()) != 0)
            fail("cannot start '{}': {}", command.front(), std::strerror(errno));
        output_ = ends[0];
        ::posix_spawn_file_actions_t actions;
        ::posix_spawn_file_actions_init(&actions);
        ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
        ::posix_spawn_file_actions_addclose(&actions, ends[0]);
        ::posix_spawn_file_actions_addclose(&actions, ends[1]);
        const int error = ::posix_spawn(&process_, command.front().c_str(), &actions, nullptr, pointers(command).data(),
                                        pointers(environment).data());
        ::posix_spawn_file_actions_destroy(&actions);
        ::close(ends[1]);
        if (error != 0) {
            ::close(output_);
            fail("cannot start '{}': {}", command.front(), std::strerror(error));
        }
    }

    ~Child() {
        ::close(output_);
        if (process_ > 0)
            stop();
    }

    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    /// What it printed since, waiting for at most `seconds`; false if it will print no more.
    bool read(double seconds, std::string& text) const {
        ::pollfd waiting{output_, POLLIN, 0};
        if (::poll(&waiting, 1, static_cast<int>(1e3 * std::max(seconds, 0.0)) + 1) <= 0)
            return true;
        std::array<char, 4096> block{};
        const ::ssize_t count = ::read(output_, block.data(), block.size());
        if (count > 0)
            text.append(block.data(), static_cast<std::size_t>(count));
        return count > 0 || (count < 0 && errno == EINTR);
    }

    void stop() {
        ::kill(process_, SIGKILL);
        wait();
    }

    /// Its status as waitpid() gives it.
    int wait() {
        int status = 0;
        while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
        }
        process_ = -1;
        return status;
    }

  private:
    int output_ = -1;
    ::pid_t process_ = -1;
};

/// Takes the whole lines from the front of the text.
void merge_lines(std::string& text, DeviceCheck& check) {
    for (std::size_t end = 0; (end = text.find('\n')) != std::string::npos; text.erase(0, end + 1))
        merge_report(text.substr(0, end), check);
}

} // namespace

DeviceCheck check_in_child(const DeviceInfo& device, const std::vector<std::string>& command,
                           const std::vector<std::string>& environment, double seconds) {
    DeviceCheck check = unfinished_check(device);
    Child child(command, environment);
    const Stopwatch stopwatch;
    std::string text;
    while (child.read(seconds - stopwatch.seconds(), text)) {
        merge_lines(text, check);
        if (stopwatch.seconds() >= seconds) {
            child.stop();
            check.out_of_time = true;
            return check;
        }
    }
    const int status = child.wait();
    if (WIFSIGNALED(status))
        check.failure = fmt::format("its driver crashed: {}", ::strsignal(WTERMSIG(status)));
    else if (WEXITSTATUS(status) != 0 && check.failure.empty())
        check.failure = fmt::format("its driver ended the program with status {}", WEXITSTATUS(status));
    return check;
}

} // namespace tristim
