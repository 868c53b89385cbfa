// The Adam optimizer (Kingma & Ba 2015), equal to PyTorch's up to rounding.
#pragma once
#include <cmath>

#include "motiongan/core/fields.hpp"
#include "motiongan/optim/optimizer.hpp"
#include "motiongan/optim/schedule.hpp"

namespace motiongan {

/// The defaults are those of WGAN-GP training, see docs/training.md.
struct AdamOptions {
  double learning_rate = 1e-4, beta1 = 0.5, beta2 = 0.9, epsilon = 1e-8;
  ScheduleOptions schedule{};  ///< applied by the trainers

  void list_fields(FieldList& list) {
    list.add(learning_rate, {.key = "learning_rate", .help = "Adam's step size", .range = Range::above(0)});
    list.add(beta1, {.key = "beta1",
                     .help = "Adam's decay rate of the mean of gradients",
                     .range = Range::between(0, 0.9999999)});
    list.add(beta2, {.key = "beta2",
                     .help = "Adam's decay rate of the mean of squared gradients",
                     .range = Range::between(0, 0.9999999)});
    list.add(epsilon, {.key = "epsilon", .help = "added to Adam's denominator", .range = Range::at_least(0)});
    schedule.list_fields(list);
  }
};

namespace detail {
inline const ElementwiseKernel clamp_kernel("clamp_between", 1, "clamp(v, (realv)a, (realv)b)");
}

/// Adam with bias correction. Its state is the running means of the gradients and of their squares.
class Adam : public Optimizer {
 public:
  explicit Adam(const std::vector<NamedParameter>& parameters, AdamOptions options = {})
      : Optimizer("Adam", parameters),
        options_(options),
        mean_(full(context(), values().shape(), 0)),
        square_(full(context(), values().shape(), 0)) {}

  const AdamOptions& options() const { return options_; }
  const char* name() const override { return "adam"; }
  std::vector<std::pair<std::string, Tensor>> state() const override {
    return {{"mean", mean_}, {"square", square_}};
  }

  /// Clips every parameter to [-limit, limit], as in the original WGAN (Arjovsky et al. 2017). Throws Error
  /// unless limit > 0.
  void clip(double limit) {
    require(limit > 0, "Adam: the clipping limit is ", limit, ", expected a number above 0");
    gather();
    detail::forget_packed(values());
    context().launch("elementwise", detail::clamp_kernel.name(), detail::vector_grid(values()), values(),
                     values(), values().size(), KernelReal{-limit}, KernelReal{limit});
  }

  /// Running means of the gradients and of their squares, all parameters concatenated: [n].
  Tensor& mean() { return mean_; }
  Tensor& square() { return square_; }

 private:
  void update() override {
    const double t = static_cast<double>(steps());
    const double step_size = rate_factor() * options_.learning_rate / (1 - std::pow(options_.beta1, t)),
                 root = std::sqrt(1 - std::pow(options_.beta2, t));
    context().launch("adam", "adam", detail::vector_grid(values()), values(), gradients(), mean_, square_,
                     values().size(), KernelReal{options_.beta1}, KernelReal{options_.beta2},
                     KernelReal{1 - options_.beta1}, KernelReal{1 - options_.beta2}, KernelReal{step_size},
                     KernelReal{root}, KernelReal{options_.epsilon});
  }

  AdamOptions options_;
  Tensor mean_, square_;
};

}  // namespace motiongan
