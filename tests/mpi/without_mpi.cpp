// What a tristim that was built without MPI does where it is one of several ranks: host/mpi/communicator_none.cpp. That
// file is compiled here whatever the build, and tests/mpirun_test.cpp runs it.

#include "base/error.h"
#include "mpi/communicator.h"

#include <cstdio>

int main() {
    try {
        return tristim::join_ranks() == nullptr && !tristim::built_with_mpi() ? 0 : 2;
    } catch (const tristim::Error& error) {
        std::puts(error.what());
        return 1;
    }
}
