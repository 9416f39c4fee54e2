#include "commands/interrupt.h"

#include <csignal>

namespace tristim {
namespace {

volatile std::sig_atomic_t caught = 0;

} // namespace

void catch_interrupts(bool among_ranks) {
    struct sigaction action {};
    action.sa_handler = [](int) {
        caught = 1;
        std::signal(SIGINT, SIG_DFL);
        std::signal(SIGTERM, SIG_DFL);
    };
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    if (among_ranks) {
        sigaction(SIGUSR1, &action, nullptr);
        sigaction(SIGUSR2, &action, nullptr);
    }
    std::signal(SIGXFSZ, SIG_IGN);
}

bool interrupted() {
    return caught != 0;
}

} // namespace tristim
