#pragma once

#include <memory>

#include "tools/vocabulary_training/communicator.hpp"

namespace kinloop {

/// Returns whether this build has MPI.
bool mpi_available();

/// Joins the processes that mpirun or srun started; this process alone if none did. Call it once and keep the
/// result until the end. A process that ends by an exception does not notify the others; the launcher ends
/// them, so that none waits for ever. Throws UsageError in a build without MPI that was started as one of
/// several processes.
std::unique_ptr<Communicator> join_mpi();

}  // namespace kinloop
