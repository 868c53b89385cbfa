// What the ranks of one training have to agree on: that it is one training, its state, and when it ends.
#pragma once
#include <string>
#include <vector>

#include "motiongan/train/trainer.hpp"

namespace motiongan::detail {

/// What ranks tell each other after an iteration.
struct RankNews {
  bool stop = false, failed = false;
};

/// Whether any rank wants to stop. Throws RankError if another one has failed.
inline bool tell_ranks(Communicator& ranks, const RankNews& own) {
  float news[] = {own.stop ? 1.0F : 0.0F, own.failed ? 1.0F : 0.0F};
  ranks.all_reduce(news);
  if (!own.failed && news[1] > 0)
    throw RankError("rank ", ranks.rank(), " ends because another rank has failed");
  return news[0] > 0;
}

/// Throws Error on each rank whose model, data or options are not those of rank 0, naming what differs, and
/// RankError on the others.
inline void require_same_training(const Trainer& trainer, Communicator& ranks) {
  io::SafeTensors own;
  trainer.describe(own);
  own.metadata["shards"] = std::to_string(trainer.parallel().shards);
  own.metadata["iterations"] = std::to_string(trainer.iterations());
  std::string first, different;  // lines `key <TAB> value`
  for (const auto& [key, text] : own.metadata) first += concat(key, '\t', text, '\n');
  first = broadcast_text(ranks, std::move(first));
  for (const auto& [key, text] : own.metadata) {
    const std::string line = concat(key, '\t', text, '\n');
    if (!different.empty() || first.find(line) != first.npos) continue;
    const std::size_t at = first.find(concat(key, '\t'));
    different =
        concat("rank ", ranks.rank(), " was started with another training than rank 0: \"", key, "\" is ",
               text.substr(0, 500), ", there ",
               at == first.npos ? std::string("it is missing") : first.substr(at + key.size() + 1, 500),
               "; give all ranks the same data and options, and the same version of the program");
  }
  tell_ranks(ranks, {.failed = !different.empty()});
  if (!different.empty()) throw Error(different);
}

/// Gives all ranks the state of rank 0: weights, optimizer states, running means and the iteration.
inline void take_state_of_first(Trainer& trainer, Communicator& ranks) {
  const auto share = [&](const Tensor& tensor) {
    std::vector<float> values = tensor.to_host();
    ranks.broadcast(std::as_writable_bytes(std::span(values)));
    if (ranks.rank() > 0) copy_tensor(Tensor::from(tensor.context(), tensor.shape(), values), tensor);
  };
  std::vector<std::uint64_t> counts{trainer.iteration()};
  for (const TrainedPart& part : trainer.parts()) {
    counts.push_back(part.optimizer->steps());
    counts.push_back(part.mean != nullptr ? part.mean->steps() : 0);
  }
  ranks.broadcast(std::as_writable_bytes(std::span(counts)));
  trainer.set_iteration(counts[0]);
  std::size_t at = 1;
  for (const TrainedPart& part : trainer.parts()) {
    part.optimizer->set_steps(counts[at++]);
    forget_packed(part.optimizer->values());
    share(part.optimizer->values());
    for (const auto& [name, tensor] : part.optimizer->state()) share(tensor);
    if (part.mean != nullptr) {
      part.mean->set_steps(counts[at]);
      share(part.mean->values());
    }
    ++at;
  }
}

}  // namespace motiongan::detail
