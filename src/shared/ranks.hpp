// The other processes of a job.
#pragma once
#include <CLI/CLI.hpp>
#include <initializer_list>
#include <memory>

#include "motiongan/distributed/communicator.hpp"

namespace motiongan::command {

/// The number of processes that the launcher, such as mpirun, says there are; 1 without one.
int launched_ranks();

/// Joins the other ranks if the program was started by mpirun with several; empty otherwise. Ranks but the
/// first print nothing to standard output from then on. Throws Error if the program was built without MPI.
std::shared_ptr<Communicator> join_ranks();

/// What a rank does of `count` things: those from `first` on.
struct Share {
  std::size_t first = 0, count = 0;
};
Share share_of(std::size_t count, const Communicator* ranks);

/// Whole runs, such as trainings, divided among the ranks: each is made by one of them. The folders must be
/// on a file system that all ranks see.
class SharedRuns {
 public:
  /// Joins the ranks, see join_ranks().
  SharedRuns() : ranks_(join_ranks()) {}

  /// Whether this rank makes the next run. Called once for each, in the same order on all ranks.
  bool takes_next() { return ranks_ == nullptr || next_++ % ranks_->size() == ranks_->rank(); }
  /// Whether this rank reports on all runs.
  bool is_first() const { return ranks_ == nullptr || ranks_->rank() == 0; }
  /// Waits until the others have made theirs. Whether no rank was stopped by a signal; `ended`: this one was
  /// not.
  bool all_ended(bool ended) const;

 private:
  std::shared_ptr<Communicator> ranks_;
  std::size_t next_ = 0;
};

/// Throws Error if one of these options is given and there are several ranks: each knows only its own share.
void need_one_rank(const Communicator* ranks, const CLI::App& verb,
                   std::initializer_list<const char*> options);

}  // namespace motiongan::command
