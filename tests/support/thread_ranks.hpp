// Ranks that are threads of one process.
#pragma once
#include <algorithm>
#include <barrier>
#include <exception>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "motiongan/distributed/communicator.hpp"

namespace motiongan::testing {

/// What the threads share.
struct Meeting {
  explicit Meeting(std::size_t size)
      : floats(size), bytes(size), barrier(static_cast<std::ptrdiff_t>(size)) {}
  std::vector<std::span<const float>> floats;
  std::vector<std::span<std::byte>> bytes;
  std::barrier<> barrier;
};

class ThreadRank : public Communicator {
 public:
  ThreadRank(std::shared_ptr<Meeting> meeting, std::size_t rank)
      : meeting_(std::move(meeting)), rank_(rank) {}
  std::size_t rank() const override { return rank_; }
  std::size_t size() const override { return meeting_->floats.size(); }

  void all_reduce(std::span<float> values) override {
    meeting_->floats[rank_] = values;
    meeting_->barrier.arrive_and_wait();
    std::vector<float> sum(values.size(), 0);
    for (const std::span<const float> one : meeting_->floats)
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += one[i];
    meeting_->barrier.arrive_and_wait();
    std::copy(sum.begin(), sum.end(), values.begin());
  }
  void broadcast(std::span<std::byte> bytes) override {
    meeting_->bytes[rank_] = bytes;
    meeting_->barrier.arrive_and_wait();
    if (rank_ > 0) std::copy(meeting_->bytes[0].begin(), meeting_->bytes[0].end(), bytes.begin());
    meeting_->barrier.arrive_and_wait();
  }
  void exchange(std::size_t partner, std::span<const float> mine, std::span<float> theirs) override {
    meeting_->floats[rank_] = mine;
    meeting_->barrier.arrive_and_wait();
    const std::span<const float> other = meeting_->floats[partner];
    std::copy(other.begin(), other.end(), theirs.begin());
    meeting_->barrier.arrive_and_wait();
  }
  void wait_for_all() override { meeting_->barrier.arrive_and_wait(); }

 private:
  std::shared_ptr<Meeting> meeting_;
  std::size_t rank_;
};

/// Runs `work` on several ranks; throws what the first of them throws.
inline void on_ranks(std::size_t size, const std::function<void(std::shared_ptr<Communicator>)>& work) {
  const auto meeting = std::make_shared<Meeting>(size);
  std::vector<std::exception_ptr> problems(size);
  std::vector<std::thread> threads;
  for (std::size_t r = 0; r < size; ++r)
    threads.emplace_back([&, r] {
      try {
        work(std::make_shared<ThreadRank>(meeting, r));
      } catch (...) {
        problems[r] = std::current_exception();
      }
    });
  for (std::thread& thread : threads) thread.join();
  for (const std::exception_ptr& problem : problems)
    if (problem) std::rethrow_exception(problem);
}

}  // namespace motiongan::testing
