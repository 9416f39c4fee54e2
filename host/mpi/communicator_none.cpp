// Where tristim is built without MPI.
#include "base/error.h"
#include "mpi/communicator.h"
#include "mpi/launcher.h"

namespace tristim {

bool built_with_mpi() {
    return false;
}

Communicator* join_ranks() {
    const std::optional<Launcher> launcher = find_launcher();
    if (launcher && launcher->size > 1)
        fail("{} started {} ranks, but this tristim was built without MPI: install libopenmpi-dev and build it anew",
             launcher->name, launcher->size);
    return nullptr;
}

Communicator* joined_ranks() {
    return nullptr;
}

void leave_ranks() {}

} // namespace tristim
