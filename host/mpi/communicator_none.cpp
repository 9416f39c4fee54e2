// Where tristim is built without MPI.
#include "base/error.h"
#include "mpi/communicator.h"
#include "mpi/launcher.h"

#include <cstdlib>

namespace tristim {

bool built_with_mpi() {
    return false;
}

Communicator* join_ranks() {
    const std::optional<Launcher> launcher = find_launcher();
    if (!launcher)
        return nullptr;
    // One that does not say so itself may have been started by Slurm's srun, which does.
    const char* tasks = std::getenv("SLURM_STEP_NUM_TASKS");
    const int ranks = launcher->size > 0 || tasks == nullptr ? launcher->size : std::atoi(tasks);
    if (ranks > 1)
        fail("{} started {} ranks, each of which would render everything, since this tristim was built without MPI: "
             "install libopenmpi-dev and build it anew, or start it once",
             launcher->name, ranks);
    return nullptr;
}

Communicator* joined_ranks() {
    return nullptr;
}

void leave_ranks() {}

} // namespace tristim
