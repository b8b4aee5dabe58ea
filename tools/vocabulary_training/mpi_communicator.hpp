#pragma once

#include <memory>

#include "tools/vocabulary_training/communicator.hpp"

namespace kinloop {

/// Whether this build has MPI.
bool mpi_available();

/// The processes that mpirun or srun started; this one alone where none did. To be called once, and to be
/// kept until the end. A process that ends by an exception leaves without a word to the others: their starter
/// sees it and ends them, so that none waits for ever. Throws UsageError in a build without MPI that was
/// started as one of many.
std::unique_ptr<Communicator> join_mpi();

}  // namespace kinloop
