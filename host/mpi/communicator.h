#pragma once

#include "shared_types.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tristim {

/// What one rank sends to another: some numbers whose meaning is theirs.
using Words = std::vector<std::uint64_t>;

struct Message {
    int from = 0;
    Words words;
};

/// This process among those, the ranks, that mpirun or the like has started together. Calls come from one thread.
/// Those marked "all" wait until every rank has made the same call; they do so without keeping a core busy, but for
/// reduce.
class Communicator {
  public:
    virtual ~Communicator() = default;

    virtual int rank() const = 0; ///< from 0
    virtual int size() const = 0;
    virtual int local_rank() const = 0; ///< among the ranks on this machine
    virtual int local_size() const = 0;

    /// Does not wait for the receiver, which may be the sender. Messages between the same two arrive in order.
    virtual void send(int to, const Words& words) = 0;

    /// A message that has come, if any.
    virtual std::optional<Message> receive() = 0;

    /// All: what rank 0 passes.
    virtual std::string broadcast(const std::string& text) = 0;

    /// All: at rank 0 what each rank passes, in order of ranks; elsewhere nothing.
    virtual std::vector<std::string> gather(const std::string& text) = 0;

    /// All: at rank 0 replaces the film by the sum (add_film) of all ranks' films; elsewhere leaves it as it is.
    virtual void reduce(std::vector<FilmPixel>& film) = 0;

    /// All: the same for plain sums.
    virtual void reduce(std::vector<float>& sums) = 0;

    /// Ends all ranks at once.
    [[noreturn]] virtual void abort(int exit_code) = 0;
};

/// Whether this tristim was built with MPI.
bool built_with_mpi();

/// Joins the ranks that were started together with this process, if it has not yet. None if it was started alone: then
/// nothing of MPI runs. Throws Error if it was started among ranks that it cannot join, such as those of another MPI.
Communicator* join_ranks();

/// The ranks that this process has joined and not left.
Communicator* joined_ranks();

/// All: leaves them.
void leave_ranks();

} // namespace tristim
