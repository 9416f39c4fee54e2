#include "commands/interrupt.h"

#include <cerrno>
#include <csignal>
#include <ctime>
#include <initializer_list>

namespace tristim {
namespace {

/// Signals that come closer together are one.
constexpr double one_signal = 0.5; ///< s

volatile std::sig_atomic_t caught = 0;
volatile double caught_at = 0.0; ///< s

double now() {
    std::timespec time{};
    ::clock_gettime(CLOCK_MONOTONIC, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void stop_soon(int) {
    const int error = errno;
    if (caught == 0)
        caught_at = now();
    caught = 1;
    errno = error;
}

void stop_soon_or_now(int signal) {
    if (caught != 0 && now() - caught_at >= one_signal) {
        std::signal(signal, SIG_DFL);
        std::raise(signal);
    }
    stop_soon(signal);
}

::sigset_t all_caught() {
    ::sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2})
        sigaddset(&signals, signal);
    return signals;
}

void handle(int signal, void (*handler)(int)) {
    struct sigaction action {};
    action.sa_handler = handler;
    action.sa_mask = all_caught(); // none interrupts another's handler
    sigaction(signal, &action, nullptr);
}

bool is_ignored(int signal) {
    struct sigaction action {};
    sigaction(signal, nullptr, &action);
    return action.sa_handler == SIG_IGN;
}

} // namespace

void catch_interrupts(bool among_ranks) {
    handle(SIGINT, stop_soon_or_now);
    handle(SIGTERM, stop_soon_or_now);
    if (!is_ignored(SIGHUP))
        handle(SIGHUP, stop_soon_or_now);
    if (among_ranks) {
        handle(SIGUSR1, stop_soon);
        handle(SIGUSR2, stop_soon);
    }
    std::signal(SIGPIPE, SIG_IGN);
    const ::sigset_t signals = all_caught(); // the process may have been started with some of them blocked
    ::pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
}

bool interrupted() {
    return caught != 0;
}

} // namespace tristim
