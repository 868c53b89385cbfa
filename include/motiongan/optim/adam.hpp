// Adam, equal to PyTorch's to rounding.
#pragma once
#include <cmath>

#include "motiongan/optim/optimizer.hpp"

namespace motiongan {

/// Defaults are SPEC 4's.
struct AdamOptions {
  double learning_rate = 1e-4, beta1 = 0.5, beta2 = 0.9, epsilon = 1e-8;
};

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

  /// Brings every parameter into [-limit, limit]: the weight clipping of the first Wasserstein GAN.
  void clip(double limit) {
    require(limit > 0, "Adam: parameters cannot be clipped at ", limit, ", expected a number above 0");
    context().launch("elementwise", "clamp_of", detail::vector_grid(values()), values(), values(),
                     values().size(), KernelReal{-limit}, KernelReal{limit});
  }

  /// The running means: all parameters one after the other.
  Tensor& mean() { return mean_; }
  Tensor& square() { return square_; }

 private:
  void update() override {
    const double t = static_cast<double>(steps());
    const double step_size = options_.learning_rate / (1 - std::pow(options_.beta1, t)),
                 root = std::sqrt(1 - std::pow(options_.beta2, t));
    context().launch("adam", "adam", detail::vector_grid(values()), values(), gradients(), mean_, square_,
                     values().size(), KernelReal{options_.beta1}, KernelReal{options_.beta2}, KernelReal{1 - options_.beta1},
                     KernelReal{1 - options_.beta2}, KernelReal{step_size}, KernelReal{root}, KernelReal{options_.epsilon});
  }

  AdamOptions options_;
  Tensor mean_, square_;
};

}  // namespace motiongan
