// The other processes of a job.
#pragma once
#include <CLI/CLI.hpp>
#include <initializer_list>
#include <memory>

#include "motiongan/distributed/communicator.hpp"

namespace motiongan::command {

/// Joins the other ranks if the program was started by mpirun with several; empty otherwise. Ranks but the
/// first print nothing to standard output from then on. Throws Error if the program was built without MPI.
std::shared_ptr<Communicator> join_ranks();

/// What a rank does of `count` things: those from `first` on.
struct Share {
  std::size_t first = 0, count = 0;
};
Share share_of(std::size_t count, const Communicator* ranks);

/// Throws Error if one of these options is given and there are several ranks: each knows only its own share.
void need_one_rank(const Communicator* ranks, const CLI::App& verb,
                   std::initializer_list<const char*> options);

}  // namespace motiongan::command
