// Ranks that are processes of an MPI job. Not part of motiongan.hpp: include it, and link MPI, where it is
// used.
#pragma once
#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <limits>
#include <string>
#include <thread>

#include "motiongan/distributed/communicator.hpp"

namespace motiongan {

/// The ranks of MPI_COMM_WORLD. At most one exists in a process; it starts MPI, and ends it if every rank
/// gets to its end. A rank that is not heard of for `timeout` seconds is taken to be lost.
class MpiRanks : public Communicator {
 public:
  /// Throws Error if MPI does not start.
  explicit MpiRanks(double timeout = 300) : timeout_(timeout) {
    int provided = 0;
    check(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided), "start");
    MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
  }
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;
  ~MpiRanks() override {
    // While something fails, other ranks wait for what this one will not send: ending MPI would wait for
    // them.
    if (whole_ && std::uncaught_exceptions() == 0) MPI_Finalize();
  }

  std::size_t rank() const override { return static_cast<std::size_t>(rank_); }
  std::size_t size() const override { return static_cast<std::size_t>(size_); }

  void all_reduce(std::span<float> values) override {
    for_pieces(values.size(), [&](std::size_t at, int count) {
      MPI_Request request{};
      check(MPI_Iallreduce(MPI_IN_PLACE, values.data() + at, count, MPI_FLOAT, MPI_SUM, MPI_COMM_WORLD,
                           &request),
            "add up");
      wait(request, "the others");
    });
  }

  void broadcast(std::span<std::byte> bytes) override {
    for_pieces(bytes.size(), [&](std::size_t at, int count) {
      MPI_Request request{};
      check(MPI_Ibcast(bytes.data() + at, count, MPI_BYTE, 0, MPI_COMM_WORLD, &request), "pass on");
      wait(request, rank_ == 0 ? "the others" : "rank 0");
    });
  }

  void exchange(std::size_t partner, std::span<const float> mine, std::span<float> theirs) override {
    const int other = static_cast<int>(partner);
    for_pieces(mine.size(), [&](std::size_t at, int count) {
      MPI_Request receive{}, send{};
      check(MPI_Irecv(theirs.data() + at, count, MPI_FLOAT, other, 0, MPI_COMM_WORLD, &receive), "receive");
      check(MPI_Isend(mine.data() + at, count, MPI_FLOAT, other, 0, MPI_COMM_WORLD, &send), "send");
      wait(receive, "rank " + std::to_string(partner));
      wait(send, "rank " + std::to_string(partner));
    });
  }

  /// mpirun ends the job if a rank fails meanwhile.
  void wait_for_all() override {
    MPI_Request request{};
    check(MPI_Ibarrier(MPI_COMM_WORLD, &request), "wait");
    for (int done = 0;; std::this_thread::sleep_for(std::chrono::milliseconds(10))) {
      check(MPI_Test(&request, &done, MPI_STATUS_IGNORE), "wait");
      if (done != 0) return;
    }
  }

 private:
  /// MPI counts in int.
  template <class Work>
  static void for_pieces(std::size_t size, const Work& work) {
    constexpr std::size_t most = std::numeric_limits<int>::max() / 16;
    for (std::size_t at = 0; at < size; at += most) work(at, static_cast<int>(std::min(most, size - at)));
  }

  void check(int code, const char* what) {
    if (code == MPI_SUCCESS) return;
    char text[MPI_MAX_ERROR_STRING];
    int length = 0;
    MPI_Error_string(code, text, &length);
    fail(concat("MPI cannot ", what, ": ", std::string(text, static_cast<std::size_t>(length))));
  }

  /// Waits, without taking a core from the device for long: kernels may run on the host.
  void wait(MPI_Request& request, const std::string& whom) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    for (std::size_t tries = 0;; ++tries) {
      int done = 0;
      check(MPI_Test(&request, &done, MPI_STATUS_IGNORE), "communicate");
      if (done != 0) return;
      if (tries < 200) continue;
      std::this_thread::sleep_for(std::chrono::microseconds(tries < 2000 ? 20 : 200));
      if (std::chrono::duration<double>(Clock::now() - start).count() > timeout_)
        fail(concat("nothing was heard of ", whom, " for ", timeout_,
                    " s: a process ended, or a host cannot be "
                    "reached"));
    }
  }

  [[noreturn]] void fail(const std::string& why) {
    whole_ = false;  // ending MPI would wait for the rank that is lost
    throw RankError("rank ", rank_, " of ", size_, ": ", why);
  }

  double timeout_;
  int rank_ = 0, size_ = 1;
  bool whole_ = true;
};

}  // namespace motiongan
