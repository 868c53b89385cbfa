// The other processes of a training.
#pragma once
#include <memory>

#include "motiongan/distributed/communicator.hpp"

namespace motiongan::command {

/// Joins the other ranks if the program was started by mpirun with several; empty otherwise. Ranks but the
/// first print nothing to standard output from then on. Throws Error if the program was built without MPI.
std::shared_ptr<Communicator> join_ranks();

}  // namespace motiongan::command
