// Adam, equal to PyTorch's to rounding.
#pragma once
#include <cmath>

#include "motiongan/nn/module.hpp"
#include "motiongan/ops/layout.hpp"

namespace motiongan {

/// Defaults are SPEC 4's.
struct AdamOptions {
  double learning_rate = 1e-4, beta1 = 0.5, beta2 = 0.9, epsilon = 1e-8;
};

/// Owns the parameters' storage: they become pieces of one buffer, and one launch updates them all.
class Adam {
 public:
  Adam(const std::vector<NamedParameter>& parameters, AdamOptions options = {})
      : options_(options), parameters_(values_of(parameters)) {
    require(!parameters.empty(), "Adam: no parameters");
    const Context context = parameters_[0].context();
    const std::size_t n = parameter_count(parameters);
    values_ = Tensor(context, {n});
    gradients_ = filled(context, {n}, 0);
    mean_ = filled(context, {n}, 0);
    square_ = filled(context, {n}, 0);
    std::size_t at = 0;
    for (const Var& p : parameters_) {
      const Tensor place = values_.view(at, p.shape());
      detail::copy_tensor(p.value(), place);
      p.node()->value = place;
      at += p.size();
    }
  }

  const std::vector<Var>& parameters() const { return parameters_; }
  const AdamOptions& options() const { return options_; }
  std::size_t steps() const { return steps_; }

  /// One update. `gradients` are those of parameters(), in order.
  void step(const std::vector<Var>& gradients) {
    require(gradients.size() == parameters_.size(), "Adam: ", gradients.size(), " gradients for ",
            parameters_.size(), " parameters");
    std::size_t at = 0;
    for (std::size_t i = 0; i < gradients.size(); ++i) {
      require(gradients[i].shape() == parameters_[i].shape(), "Adam: gradient ", i, " has shape ",
              gradients[i].shape(), ", the parameter ", parameters_[i].shape());
      detail::copy_tensor(gradients[i].value(), gradients_.view(at, gradients[i].shape()));
      at += gradients[i].size();
    }
    ++steps_;
    const double t = static_cast<double>(steps_);
    const double step_size = options_.learning_rate / (1 - std::pow(options_.beta1, t)),
                 root = std::sqrt(1 - std::pow(options_.beta2, t));
    values_.context().launch("adam", "adam", detail::vector_grid(values_), values_, gradients_, mean_,
                             square_, values_.size(), Real{options_.beta1}, Real{options_.beta2},
                             Real{1 - options_.beta1}, Real{1 - options_.beta2}, Real{step_size}, Real{root},
                             Real{options_.epsilon});
  }

  /// Brings every parameter into [-limit, limit]: the weight clipping of the first Wasserstein GAN.
  void clip(double limit) {
    require(limit > 0, "Adam: parameters cannot be clipped at ", limit, ", expected a number above 0");
    values_.context().launch("elementwise", "clamp_of", detail::vector_grid(values_), values_, values_,
                             values_.size(), Real{-limit}, Real{limit});
  }

  /// The running means, for checkpoints: all parameters one after the other.
  Tensor& mean() { return mean_; }
  Tensor& square() { return square_; }
  void set_steps(std::size_t steps) { steps_ = steps; }

 private:
  AdamOptions options_;
  std::vector<Var> parameters_;
  Tensor values_, gradients_, mean_, square_;
  std::size_t steps_ = 0;
};

}  // namespace motiongan
