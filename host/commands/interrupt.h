#pragma once

namespace tristim {

/// From now on the first SIGINT or SIGTERM only sets interrupted(); a second one ends the process as usual. Where the
/// process is one of several ranks, SIGUSR1 and SIGUSR2 do so too: mpirun passes them on and leaves it at that. And a
/// limit on the size of files makes writing fail instead of ending the process.
void catch_interrupts(bool among_ranks = false);
bool interrupted();

/// The exit status of a render that was interrupted and has saved all that it had done.
inline constexpr int exit_interrupted_and_saved = 3;

} // namespace tristim
