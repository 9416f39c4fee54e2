// Signals that end a render: host/commands/interrupt.h; and a stderr that cannot be written: host/base/tell.h.

#include "base/stopwatch.h"
#include "base/tell.h"
#include "checkpoint_renders.h"
#include "child_process.h"
#include "commands/interrupt.h"

#include <csignal>
#include <fcntl.h>

namespace tristim::test {
namespace {

void expect_alive_and_interrupted() {
    if (!interrupted())
        std::_Exit(1);
}

/// `timeout` sends SIGTERM to its child, and then to the group that this is in.
TEST(Interrupt, SignalsInARowAreOneAndALaterOneEnds) {
    const auto end = [](int later) {
        catch_interrupts();
        for (const int signal : {SIGINT, SIGTERM, SIGTERM, SIGHUP}) {
            std::raise(signal);
            expect_alive_and_interrupted();
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(550));
        std::raise(later);
        std::_Exit(0);
    };
    EXPECT_EXIT(end(SIGTERM), testing::KilledBySignal(SIGTERM), "");
    EXPECT_EXIT(end(SIGHUP), testing::KilledBySignal(SIGHUP), "");
}

TEST(Interrupt, UnderNohupAClosedTerminalIsNone) {
    const auto end = [] {
        std::signal(SIGHUP, SIG_IGN);
        catch_interrupts();
        std::raise(SIGHUP);
        std::_Exit(interrupted() ? 1 : 0);
    };
    EXPECT_EXIT(end(), testing::ExitedWithCode(0), "");
}

/// Gives stderr another file for a while.
class OtherStderr {
  public:
    explicit OtherStderr(int descriptor) { ::dup2(descriptor, STDERR_FILENO); }
    ~OtherStderr() {
        ::dup2(own_, STDERR_FILENO);
        ::close(own_);
    }
    OtherStderr(const OtherStderr&) = delete;
    OtherStderr& operator=(const OtherStderr&) = delete;

  private:
    int own_ = ::dup(STDERR_FILENO);
};

TEST(Tell, APipeThatNobodyEmptiesHoldsNobodyUp) {
    std::array<int, 2> ends{};
    ASSERT_EQ(::pipe2(ends.data(), O_NONBLOCK), 0);
    const std::string block(4096, 'x');
    while (::write(ends[1], block.data(), block.size()) > 0) {
    }
    ::fcntl(ends[1], F_SETFL, 0); // from now on writing would wait
    const Stopwatch stopwatch;
    {
        const OtherStderr full(ends[1]);
        tell("{}", "lost");
    }
    EXPECT_LT(stopwatch.seconds(), 5.0);
    std::string read(block.size(), '\0');
    ASSERT_EQ(::read(ends[0], read.data(), read.size()), 4096);
    {
        const OtherStderr emptied(ends[1]);
        tell("{} {}", "not", "lost");
    }
    std::string last;
    for (::ssize_t count = 0; (count = ::read(ends[0], read.data(), read.size())) > 0;)
        last = read.substr(0, static_cast<std::size_t>(count));
    EXPECT_EQ(last.substr(last.find_last_of('x') + 1), "not lost");
    ::close(ends[0]);
    ::close(ends[1]);
}

/// A stderr that is closed, on a full disk or a pipe that has lost its reader: the render ends as if it could talk.
TEST(Tell, WithoutStderrARenderIsDone) {
    const CheckpointRenders renders;
    for (const char* line : {"\"$@\" 2> /dev/full", "\"$@\" 2>&-",
                             "{ sleep 0.1; \"$@\"; echo $? > \"$status\"; } 2>&1 | :; exit $(cat \"$status\")"}) {
        std::vector<std::string> words{"-c", line, "sh", TRISTIM_COMMAND};
        const std::vector<std::string> command = renders.command({"--passes=2", "--checkpoint", renders.path("a.exr")});
        words.insert(words.end(), command.begin(), command.end());
        const ChildResult result = run_program("/bin/sh", words, {{"status", renders.path("status")}});
        EXPECT_EQ(result.exit_code, 0) << line << result.standard_error;
        EXPECT_TRUE(std::filesystem::remove(renders.path("image.exr"))) << line;
        EXPECT_TRUE(std::filesystem::remove(renders.path("a.exr"))) << line;
    }
}

} // namespace
} // namespace tristim::test
