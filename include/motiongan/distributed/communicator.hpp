// Several processes, or threads, that train one model together.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "motiongan/core/error.hpp"

namespace motiongan {

/// Thrown where another rank has failed, or cannot be reached.
class RankError : public Error {
 public:
  using Error::Error;
};

/// One of several ranks that work together. All ranks make the same calls in the same order, with as many
/// values; a call returns when what this rank needs has arrived. Implementations throw RankError if it does
/// not.
class Communicator {
 public:
  virtual ~Communicator() = default;

  virtual std::size_t rank() const = 0;  ///< 0 .. size() - 1
  virtual std::size_t size() const = 0;  ///< number of processes

  /// Replaces the values by their sums over all ranks, equal on all ranks, added in any order.
  virtual void all_reduce(std::span<float> values) = 0;
  /// Replaces the bytes by those of rank 0.
  virtual void broadcast(std::span<std::byte> bytes) = 0;
  /// Sends values to another rank, which does the same, and receives its values.
  virtual void exchange(std::size_t partner, std::span<const float> mine, std::span<float> theirs) = 0;
  /// Returns when all ranks have come here, however long that takes.
  virtual void wait_for_all() = 0;
};

/// The sums over all ranks, added as a binary tree whose leaves are the ranks in order. If the values of a
/// rank are sums of such a tree already, the bits are those of the whole tree, however many ranks share its
/// leaves. The number of ranks must be a power of two.
inline void all_reduce_in_order(Communicator& ranks, std::span<float> values) {
  std::vector<float> theirs(values.size());
  for (std::size_t far = 1; far < ranks.size(); far *= 2) {
    ranks.exchange(ranks.rank() ^ far, values, theirs);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] += theirs[i];  // a + b has the bits of b + a
  }
}

/// The text of rank 0, on all ranks.
inline std::string broadcast_text(Communicator& ranks, std::string text) {
  std::uint64_t length = text.size();
  ranks.broadcast(std::as_writable_bytes(std::span(&length, 1)));
  text.resize(length);
  ranks.broadcast(std::as_writable_bytes(std::span(text)));
  return text;
}

}  // namespace motiongan
