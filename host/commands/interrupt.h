#pragma once

namespace tristim {

/// From now on the first SIGINT, SIGTERM or SIGHUP only sets interrupted(); one that follows half a second later or
/// more ends the process as usual. Before that it counts as the same: `timeout` sends one to the process and one to its
/// group, and some launchers do so too. Where SIGHUP was ignored (nohup) it stays so. Where the process is one of
/// several ranks, SIGUSR1 and SIGUSR2 set interrupted() too: mpirun passes them on and leaves it at that. And a closed
/// pipe makes writing fail instead of ending the process.
void catch_interrupts(bool among_ranks = false);
bool interrupted();

/// The exit status of a render that was interrupted and has saved all that it had done.
inline constexpr int exit_interrupted_and_saved = 3;

} // namespace tristim
