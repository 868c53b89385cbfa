// The other processes of a job, by MPI. Compiled by itself, for the sake of MPI's header.
#include "shared/ranks.hpp"

#include <cstdio>
#include <cstdlib>

#if MOTIONGAN_WITH_MPI
#include "motiongan/distributed/mpi.hpp"
#endif

namespace motiongan::command {

int launched_ranks() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MV2_COMM_WORLD_SIZE"})
    if (const char* const text = std::getenv(name)) return std::atoi(text);
  return 1;
}

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

Share share_of(std::size_t count, const Communicator* ranks) {
  if (ranks == nullptr) return {0, count};
  const std::size_t first = count * ranks->rank() / ranks->size(),
                    end = count * (ranks->rank() + 1) / ranks->size();
  return {first, end - first};
}

bool SharedRuns::all_ended(bool ended) const {
  if (ranks_ == nullptr) return ended;
  ranks_->wait_for_all();
  float stopped = ended ? 0 : 1;
  ranks_->all_reduce({&stopped, 1});
  return stopped == 0;
}

void need_one_rank(const Communicator* ranks, const CLI::App& verb,
                   std::initializer_list<const char*> options) {
  if (ranks == nullptr) return;
  for (const char* const option : options)
    require(verb.count(option) == 0, option,
            " needs all motions in one process; without mpirun, or look at the "
            "files afterwards: motiongan view");
}

}  // namespace motiongan::command
