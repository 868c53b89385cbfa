// Stochastic gradient descent with learning rate decay and gradient norm clipping.
#pragma once
#include <cmath>

#include "motiongan/core/fields.hpp"
#include "motiongan/optim/optimizer.hpp"

namespace motiongan {

/// The defaults are those of the residual seq2seq model (Martinez, Black & Romero 2017).
struct SgdOptions {
  double learning_rate = 0.005;
  double decay = 0.95;               ///< factor of the learning rate ...
  std::size_t decay_every = 10'000;  ///< ... applied after every decay_every steps; 0: never
  double clip_norm = 5;              ///< maximum gradient norm over all parameters together; 0: no limit

  void list_fields(FieldList& list) {
    list.add(learning_rate, {.key = "sgd_learning_rate", .help = "step size", .range = Range::above(0)});
    list.add(decay,
             {.key = "decay", .help = "factor of the learning rate at each decay", .range = Range::above(0)});
    list.add(decay_every, {.key = "decay_every", .help = "steps between two decays; 0: never"});
    list.add(clip_norm, {.key = "clip_norm",
                         .help = "largest norm of the gradient; 0: no limit",
                         .range = Range::at_least(0)});
  }
};

/// parameter -= rate * clipped gradient. The gradient's norm stays on the device: nothing is read back.
class Sgd : public Optimizer {
 public:
  explicit Sgd(const std::vector<NamedParameter>& parameters, SgdOptions options = {})
      : Optimizer("Sgd", parameters), options_(options) {
    require(options.learning_rate > 0 && options.decay > 0 && options.clip_norm >= 0, "Sgd: learning rate ",
            options.learning_rate, ", decay ", options.decay, ", clip_norm ", options.clip_norm,
            "; the first two must be above 0, the last at least 0");
    const std::size_t n = values().size();
    chunks_ = Tensor(context(), {(n + chunk - 1) / chunk});
  }

  const SgdOptions& options() const { return options_; }
  const char* name() const override { return "sgd"; }
  std::vector<std::pair<std::string, Tensor>> state() const override { return {}; }

  /// The learning rate of the next step after `done` steps.
  double rate(std::size_t done) const {
    if (options_.decay_every == 0) return options_.learning_rate;
    const std::size_t falls = done / options_.decay_every;
    return options_.learning_rate * std::pow(options_.decay, static_cast<double>(falls));
  }

 private:
  static constexpr std::size_t chunk = 4096;  // elements summed by one team

  void update() override {
    Tensor square = chunks_;
    if (options_.clip_norm > 0) {
      detail::launch_rows(context(), "squares_of_chunks", chunks_.size(), chunk, gradients(), chunks_,
                          gradients().size(), chunk);
      square = detail::sum_axis_value(chunks_, 1, chunks_.size(), 1, 1, {1});
    }
    context().launch("sgd", "sgd", detail::vector_grid(values()), values(), gradients(), square,
                     values().size(), KernelReal{rate_factor() * rate(steps() - 1)},
                     KernelReal{options_.clip_norm});
  }

  SgdOptions options_;
  Tensor chunks_;
};

}  // namespace motiongan
