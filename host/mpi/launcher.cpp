#include "mpi/launcher.h"

#include <cstdlib>
#include <fmt/format.h>
#include <sched.h>
#include <unistd.h>

namespace tristim {

std::optional<Launcher> find_launcher() {
    struct Known {
        const char* variable; ///< that it sets in every rank
        const char* name;
        bool holds_size;
    };
    // MPICH's and Intel's launchers and srun --mpi=pmi2 speak PMI; srun --mpi=pmix speaks PMIx, and tells no size so.
    constexpr Known known[] = {{"OMPI_COMM_WORLD_SIZE", "Open MPI's mpirun", true},
                               {"PMI_SIZE", "a launcher that speaks PMI", true},
                               {"PMIX_RANK", "a launcher that speaks PMIx", false}};
    for (const Known& launcher : known) {
        if (const char* value = std::getenv(launcher.variable))
            return Launcher{launcher.name, launcher.holds_size ? std::atoi(value) : 0};
    }
    return {};
}

std::string binding_note(int local_ranks) {
    ::cpu_set_t bound;
    const auto cores = static_cast<int>(::sysconf(_SC_NPROCESSORS_ONLN));
    if (::sched_getaffinity(0, sizeof bound, &bound) != 0 || CPU_COUNT(&bound) * local_ranks >= cores)
        return {};
    return fmt::format("this rank may run on {} of {} cores only: `mpirun --bind-to none` gives it all",
                       CPU_COUNT(&bound), cores);
}

} // namespace tristim
