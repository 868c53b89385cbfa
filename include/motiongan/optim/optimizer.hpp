// Base class of the optimizers: keeps all parameters in one buffer, so that one launch updates them all.
#pragma once
#include <utility>

#include "motiongan/core/keep_packed.hpp"
#include "motiongan/nn/module.hpp"
#include "motiongan/ops/layout.hpp"

namespace motiongan {

/// Moves the parameters into one buffer, of which they become views. Optimizers can share a parameter: each
/// moves it back before it updates it.
class Optimizer {
 public:
  virtual ~Optimizer() = default;
  Optimizer(const Optimizer&) = delete;
  Optimizer& operator=(const Optimizer&) = delete;

  /// Its name in checkpoints and error messages.
  virtual const char* name() const = 0;
  /// Optimizer state for checkpoints, besides steps(): named device tensors, [n] each, over all parameters
  /// concatenated.
  virtual std::vector<std::pair<std::string, Tensor>> state() const = 0;

  /// What is optimised.
  const std::vector<Var>& parameters() const { return parameters_; }
  /// All parameters concatenated, [n]: the memory that they are views of.
  const Tensor& values() const { return values_; }
  /// The number of steps taken; set_steps() is for a run that resumes.
  /// \{
  std::size_t steps() const { return steps_; }
  void set_steps(std::size_t steps) { steps_ = steps; }
  /// \}
  /// The next steps are made with this share of the learning rate, 1 at first. Not part of the state.
  void set_rate_factor(double factor) { rate_factor_ = factor; }

  /// One update; `gradients` in the order of parameters(). Throws Error if their number or a shape does not
  /// match; then no parameter has changed.
  void step(const std::vector<Var>& gradients) {
    require(gradients.size() == parameters_.size(), title_, ": ", gradients.size(), " gradients for ",
            parameters_.size(), " parameters");
    std::vector<detail::CopyPart> copies;
    std::size_t at = 0;
    for (std::size_t i = 0; i < gradients.size(); ++i) {
      require(gradients[i].shape() == parameters_[i].shape(), title_, ": gradient ", i, " has shape ",
              gradients[i].shape(), ", the parameter ", parameters_[i].shape());
      copies.push_back({gradients[i].value(), at});
      at += gradients[i].size();
    }
    detail::copy_parts(copies, gradients_, 1, 0);
    step_from_gradients();
  }

  /// The same; `gradients` are those of all parameters concatenated, [n].
  void step(const Tensor& gradients) {
    require(gradients.shape() == gradients_.shape(), title_, ": gradients ", gradients.shape(), ", expected ",
            gradients_.shape());
    detail::copy_tensor(gradients, gradients_);
    step_from_gradients();
  }

 protected:
  /// `title` names the optimizer in error messages. Throws Error if there are no parameters or one is listed
  /// twice.
  Optimizer(const char* title, const std::vector<NamedParameter>& parameters)
      : title_(title), parameters_(values_of(parameters)) {
    require(!parameters.empty(), title, ": no parameters");
    for (std::size_t i = 0; i < parameters.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        require(parameters_[i].node() != parameters_[j].node(), title, ": the parameters \"",
                parameters[j].name, "\" and \"", parameters[i].name, "\" are one; list it once");
    const Context context = parameters_[0].context();
    const std::size_t n = parameter_count(parameters);
    values_ = Tensor(context, {n});
    gradients_ = full(context, {n}, 0);
    gather();
  }

  /// Moves the parameters into values(), those that are not there already. Before values() changes.
  void gather() {
    std::size_t at = 0;
    for (const Var& p : parameters_) {
      const Tensor& value = p.value();
      if (!value.shares_memory(values_) || value.offset() != at) {
        const Tensor place = values_.view(at, p.shape());
        detail::copy_tensor(value, place);
        p.node()->value = place;
      }
      at += p.size();
    }
  }

  /// Updates values() from gradients(); steps() already counts this step.
  virtual void update() = 0;

  /// The share of the learning rate in this step.
  double rate_factor() const { return rate_factor_; }
  const Tensor& gradients() const { return gradients_; }  ///< in the order of values(), [n]
  const Context& context() const { return values_.context(); }

 private:
  void step_from_gradients() {
    gather();
    detail::forget_packed(values_);
    ++steps_;
    update();
  }

  const char* title_;
  std::vector<Var> parameters_;
  Tensor values_, gradients_;
  std::size_t steps_ = 0;
  double rate_factor_ = 1;
};

}  // namespace motiongan
