// Stopping in the middle of an iteration, with the state of the last whole one.
#pragma once
#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include "motiongan/core/clock.hpp"
#include "motiongan/train/trainer.hpp"

namespace motiongan::detail {

/// Runs the iterations of a trainer, and gives one up when `interrupted` becomes true. Only an iteration that
/// may take longer than `long_iteration` seconds can be given up: it costs a copy of all parameters and
/// optimizer states on the device, and the host stays close to the device. Shorter ones are finished.
class Interruption {
 public:
  Interruption(Trainer& trainer, std::function<bool()> interrupted, double long_iteration)
      : trainer_(trainer),
        context_(trainer.parts().front().parameters.front().value->context()),
        interrupted_(std::move(interrupted)),
        long_iteration_(long_iteration) {}

  /// One iteration. Returns false if it was given up: the trainer is as it was before.
  bool iterate() {
    const double now = clock_seconds();
    // Including what comes between iterations: only there does the host wait for the device.
    if (started_ > 0) seconds_ = std::max(now - started_, seconds_ < first_seconds ? 0.9 * seconds_ : 0);
    started_ = now;
    if (!interrupted_) {
      trainer_.iterate();
      return true;
    }
    if (seconds_ < long_iteration_) {
      stay_close();
      trainer_.iterate();
      return true;
    }
    keep_state();
    try {
      const Interruptible guard(context_, interrupted_);
      trainer_.iterate();
      return true;
    } catch (const Interrupted&) {
      restore_state();
      return false;
    }
  }

 private:
  /// The first iteration is taken to be long: kernels are built in it.
  static constexpr double first_seconds = 1e9;

  /// At most one iteration is left in the queue when the next one begins.
  void stay_close() {
    if (marker_) context_.wait_for(marker_);
    marker_ = context_.marker();
  }

  static std::vector<Tensor> tensors_of(const TrainedPart& part) {
    std::vector<Tensor> out{part.optimizer->values()};
    for (const auto& [name, tensor] : part.optimizer->state()) out.push_back(tensor);
    if (part.mean != nullptr) out.push_back(part.mean->values());
    return out;
  }

  void keep_state() {
    std::size_t at = 0;
    steps_.clear();
    for (const TrainedPart& part : trainer_.parts()) {
      for (const Tensor& tensor : tensors_of(part)) {
        if (at == kept_.size()) kept_.emplace_back(tensor.context(), tensor.shape());
        copy_tensor(tensor, kept_[at++]);
      }
      steps_.push_back(part.optimizer->steps());
      steps_.push_back(part.mean != nullptr ? part.mean->steps() : 0);
    }
  }

  void restore_state() {
    std::size_t at = 0, k = 0;
    for (const TrainedPart& part : trainer_.parts()) {
      for (const Tensor& tensor : tensors_of(part)) copy_tensor(kept_[at++], tensor);
      part.optimizer->set_steps(steps_[k++]);
      if (part.mean != nullptr) part.mean->set_steps(steps_[k]);
      ++k;
    }
  }

  Trainer& trainer_;
  Context context_;
  std::function<bool()> interrupted_;
  double long_iteration_;
  double started_ = 0, seconds_ = first_seconds;
  ClEvent marker_;
  std::vector<Tensor> kept_;
  std::vector<std::size_t> steps_;
};

}  // namespace motiongan::detail
