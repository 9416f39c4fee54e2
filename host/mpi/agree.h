#pragma once

#include "mpi/communicator.h"
#include "render/options.h"

#include <functional>
#include <string>

namespace tristim {

/// Ends a rank where another one tells the user why. All ranks have left each other by then.
struct EndedElsewhere {
    int exit_code = 0;
};

/// Does something at every rank. If it fails at any (Error or an OpenCL error), all leave: rank 0 throws an Error that
/// tells which ranks failed and why, others throw EndedElsewhere. Without ranks (nullptr), just does it.
void at_all_ranks(Communicator* ranks, const std::function<void()>& step);

/// Does something at rank 0 and returns its exit code, at every rank. If it fails, all leave: rank 0 throws what was
/// thrown there, others throw EndedElsewhere. Without ranks, just does it.
int at_first_rank(Communicator* ranks, const std::function<int()>& step);

/// All: fails unless every rank has the same scene, kernels and options as rank 0, as ranks may not that read them from
/// disks of their own.
void check_same_image(Communicator& ranks, const Scene& scene, const RenderOptions& options);

} // namespace tristim
