// The other processes of a training: those of an MPI job. Compiled by itself, for the sake of MPI's header.
#include "train/ranks.hpp"

#include <cstdio>
#include <cstdlib>

#if MOTIONGAN_WITH_MPI
#include "motiongan/distributed/mpi.hpp"
#endif

namespace motiongan::command {
namespace {

/// The number of ranks that a launcher says there are; 1 if none does.
int launched_ranks() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MV2_COMM_WORLD_SIZE"})
    if (const char* const text = std::getenv(name)) return std::atoi(text);
  return 1;
}

}  // namespace

std::shared_ptr<Communicator> join_ranks() {
  if (launched_ranks() < 2) return {};
#if MOTIONGAN_WITH_MPI
  auto ranks = std::make_shared<MpiRanks>();
  if (ranks->rank() > 0 && std::freopen("/dev/null", "w", stdout) == nullptr) std::fclose(stdout);
  return ranks;
#else
  throw Error(
      "mpirun started several processes, but this motiongan was built without MPI; on Debian: apt-get "
      "install libopenmpi-dev, and build it again");
#endif
}

}  // namespace motiongan::command
