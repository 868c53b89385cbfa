// Weights packed for matrix products are kept and used again while they do not change.
#pragma once
#include <array>
#include <map>
#include <tuple>

#include "motiongan/core/tensor.hpp"

namespace motiongan {

namespace detail {

/// What was packed: the layout's numbers, the first of which names the layout; the rest is 0.
using PackKey = std::array<std::size_t, 12>;

/// The packed tensors of a thread.
class PackedTensors {
 public:
  /// The packed form of `source`, from before or from `make()`.
  template <class Make>
  Tensor get(const Tensor& source, const PackKey& key, Make make) {
    const auto found = entries_.find({source.memory(), source.offset(), key});
    if (found != entries_.end()) {
      found->second.used = changes_;
      return found->second.packed;
    }
    Tensor packed = make();
    entries_.insert({{source.memory(), source.offset(), key}, {source, packed, changes_}});
    return packed;
  }

  /// `memory` is about to change. Also forgets what was not used since the change before: weights that were
  /// computed, rather than parameters.
  void forget(const Tensor& memory) {
    std::erase_if(entries_, [&](const auto& entry) {
      return entry.second.source.shares_memory(memory) || entry.second.used < changes_;
    });
    ++changes_;
  }

  std::size_t size() const { return entries_.size(); }

  /// Those of this thread; null without KeepPacked.
  static PackedTensors*& current() {
    thread_local PackedTensors* tensors = nullptr;
    return tensors;
  }

 private:
  using Key = std::tuple<const void*, std::size_t, PackKey>;  // memory, offset, layout
  struct Entry {
    Tensor source, packed;  // the source keeps its memory from being used for another tensor
    std::size_t used;
  };
  std::map<Key, Entry> entries_;
  std::size_t changes_ = 0;
};

/// The packed form of `source`: kept if KeepPacked is in force.
template <class Make>
Tensor packed_once(const Tensor& source, const PackKey& key, Make make) {
  PackedTensors* kept = PackedTensors::current();
  return kept ? kept->get(source, key, make) : make();
}

/// To be called before a tensor is changed in place.
inline void forget_packed(const Tensor& memory) {
  if (PackedTensors* kept = PackedTensors::current()) kept->forget(memory);
}

}  // namespace detail

/// While an object of this class exists, this thread packs weights once between two changes of them: for a
/// loop of training steps, in which the same weights are multiplied in the forward pass, the penalty and both
/// backward passes. An Optimizer's step is noticed; parameters that are changed in another way must not be
/// used before the object is gone. Takes up to four times the memory of the weights.
class KeepPacked {
 public:
  KeepPacked() : before_(detail::PackedTensors::current()) {
    if (!before_) detail::PackedTensors::current() = &tensors_;
  }
  ~KeepPacked() { detail::PackedTensors::current() = before_; }
  KeepPacked(const KeepPacked&) = delete;
  KeepPacked& operator=(const KeepPacked&) = delete;

 private:
  detail::PackedTensors* before_;
  detail::PackedTensors tensors_;
};

}  // namespace motiongan
