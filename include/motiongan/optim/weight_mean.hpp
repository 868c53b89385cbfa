// A running mean of a network's weights while it is trained.
#pragma once
#include <algorithm>
#include <cmath>
#include <list>
#include <vector>

#include "motiongan/core/fields.hpp"
#include "motiongan/optim/optimizer.hpp"

namespace motiongan {

namespace detail {
inline const ElementwiseKernel towards_kernel("towards", 2, "fma(w - v, (realv)a, v)");
}

/// The exponentially weighted mean of the values of an optimizer's parameters (Polyak & Juditsky 1992; for
/// adversarial training Yazici et al. 2019): the generator circles around a good one, and the mean is nearer
/// to it than the last step. It moves by a share of its distance to the values in each step, by
///   max((1 - decay) / (1 - decay^t), 9 / (10 + t)),   t = 1, 2, ...
/// so it is free of the bias towards its start and, while the weights still change fast, as short as a tenth
/// of the steps so far.
class WeightMean {
 public:
  /// Of the parameters of `optimizer`, which must outlive this.
  WeightMean(const Optimizer& optimizer, double decay)
      : optimizer_(optimizer),
        decay_(decay),
        values_(full(optimizer.values().context(), optimizer.values().shape(), 0)) {}

  double decay() const { return decay_; }
  std::size_t steps() const { return steps_; }
  void set_steps(std::size_t steps) { steps_ = steps; }

  /// The mean of all parameters concatenated, [n], in the order of the optimizer's; 0 before the first step.
  const Tensor& values() const { return values_; }

  /// To be called after each step of the optimizer.
  void update() {
    ++steps_;
    const auto t = static_cast<double>(steps_);
    const double share = steps_ == 1 ? 1 : std::max((1 - decay_) / (1 - std::pow(decay_, t)), 9 / (10 + t));
    values_.context().launch("elementwise", detail::towards_kernel.name(), detail::vector_grid(values_),
                             values_, optimizer_.values(), values_, values_.size(), KernelReal{share},
                             KernelReal{0});
  }

  /// `parameters`, which are those of the optimizer, with their means as values. The Vars are kept in `hold`.
  std::vector<NamedParameter> means_of(const std::vector<NamedParameter>& parameters,
                                       std::list<Var>& hold) const {
    std::vector<NamedParameter> out;
    std::size_t at = 0;
    for (const NamedParameter& p : parameters) {
      hold.push_back(Var::constant(values_.view(at, p.value->shape())));
      out.push_back({p.name, &hold.back(), p.layout});
      at += p.value->size();
    }
    return out;
  }

  /// Gives the optimizer's parameters their means; without steps they stay as they are.
  void apply() const {
    if (steps_ == 0) return;
    detail::forget_packed(optimizer_.values());
    detail::copy_tensor(values_, optimizer_.values());
  }

 private:
  const Optimizer& optimizer_;
  double decay_;
  Tensor values_;
  std::size_t steps_ = 0;
};

/// The option of the trainings that keep one.
inline void list_ema(FieldList& list, double& decay) {
  list.add(decay, {.key = "ema",
                   .help = "decay of the running mean of the generator's weights, which then generates; 0: "
                           "generate with the last weights",
                   .range = Range::between(0, 0.999999)});
}

}  // namespace motiongan
