// A step of an optimizer from the gradients of the parts of a batch, made by several ranks.
#pragma once
#include <memory>
#include <utility>
#include <vector>

#include "motiongan/autograd/grad.hpp"
#include "motiongan/distributed/communicator.hpp"
#include "motiongan/optim/optimizer.hpp"

namespace motiongan {

/// Samples first .. first + count - 1 of a batch.
struct BatchPart {
  std::size_t first = 0, count = 0;
};

/// How batches are divided among ranks.
struct Parallel {
  std::shared_ptr<Communicator> ranks = {};  ///< empty: this process alone
  /// Parts of a batch whose gradients are made one by one and added in one order, so that the bits do not
  /// depend on the number of ranks; 0: a part for each rank, added in any order.
  std::size_t shards = 0;

  std::size_t rank() const { return ranks ? ranks->rank() : 0; }
  std::size_t size() const { return ranks ? ranks->size() : 1; }
  /// Whether this process writes the files.
  bool is_first() const { return rank() == 0; }
  /// The number of parts of a batch.
  std::size_t parts() const { return shards > 0 ? shards : size(); }
};

/// Throws Error unless batches of this size can be divided so.
inline void check_parallel(const Parallel& how, std::size_t batch) {
  const std::size_t parts = how.parts(), ranks = how.size();
  require(batch % parts == 0, "a batch of ", batch, " cannot be cut into ", parts,
          how.shards > 0 ? " shards" : " parts, one for each rank",
          " of equal size; choose a --batch that is a multiple of it");
  if (how.shards == 0) return;
  const bool power = (ranks & (ranks - 1)) == 0;
  require(power && how.shards % ranks == 0 && (how.shards & (how.shards - 1)) == 0, how.shards,
          " shards and ", ranks,
          " ranks: expected powers of two, and no more ranks than shards; without --shards any number of "
          "ranks will do");
}

/// The loss of a part of a batch: a mean over its samples. What is told beside it, each [1], is averaged over
/// the parts.
struct PartLoss {
  Var loss;  ///< to differentiate
  std::vector<Var> told = {};
};

namespace detail {

/// Gradients and what is told of a part, in one buffer [n + told].
inline Tensor gradients_of(const Optimizer& optimizer, const PartLoss& part) {
  const std::vector<Var> gradients = grad(part.loss, optimizer.parameters());
  std::vector<CopyPart> copies;
  std::size_t at = 0;
  for (const std::vector<Var>* const all : {&gradients, &part.told})
    for (const Var& v : *all) {
      copies.push_back({v.value(), at});
      at += v.size();
    }
  Tensor out(optimizer.values().context(), {at});
  copy_parts(copies, out, 1, 0);
  return out;
}

/// The sum of buffers that come one after the other, added as a binary tree.
class TreeSum {
 public:
  void add(Tensor value) {
    std::size_t height = 0;
    const NoGrad values_only;
    for (; !open_.empty() && open_.back().first == height; ++height, open_.pop_back())
      value = (Var::constant(open_.back().second) + Var::constant(value)).value();
    open_.emplace_back(height, std::move(value));
  }
  /// Of a number of buffers that is a power of two.
  const Tensor& sum() const { return open_.front().second; }

 private:
  std::vector<std::pair<std::size_t, Tensor>> open_;  // height of the tree, its sum
};

}  // namespace detail

/// One update from a batch: `loss_of(part)` gives the PartLoss of a BatchPart. Of several parts the mean
/// counts. Returns the means of what is told. Throws Error as check_parallel().
template <class LossOf>
std::vector<Var> parallel_step(Optimizer& optimizer, const Parallel& how, std::size_t batch,
                               const LossOf& loss_of) {
  if (how.parts() == 1) {
    PartLoss whole = loss_of(BatchPart{0, batch});
    optimizer.step(grad(whole.loss, optimizer.parameters()));
    for (Var& v : whole.told) v = v.detach();
    return std::move(whole.told);
  }
  check_parallel(how, batch);
  const std::size_t parts = how.parts(), mine = parts / how.size(), count = batch / parts;
  detail::TreeSum sum;
  for (std::size_t p = how.rank() * mine; p < (how.rank() + 1) * mine; ++p)
    sum.add(detail::gradients_of(optimizer, loss_of(BatchPart{p * count, count})));
  std::vector<float> values = sum.sum().to_host();
  if (how.size() > 1) {
    if (how.shards > 0)
      all_reduce_in_order(*how.ranks, values);
    else
      how.ranks->all_reduce(values);
  }
  const float share = 1 / static_cast<float>(parts);
  for (float& v : values) v *= share;
  const Context& context = optimizer.values().context();
  const Tensor all = Tensor::from(context, {values.size()}, values);
  const std::size_t n = optimizer.values().size();
  optimizer.step(all.view(0, {n}));
  std::vector<Var> told;
  for (std::size_t at = n; at < values.size(); ++at) told.push_back(Var::constant(all.view(at, {1})));
  return told;
}

}  // namespace motiongan
