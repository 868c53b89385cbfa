// One-hot encoding and cross-entropy.
#pragma once
#include <span>

#include "motiongan/ops/reduce.hpp"

namespace motiongan {

/// One-hot encoding of class labels: [B, classes]. Throws Error if a label is not less than `classes`.
inline Tensor one_hot(const Context& context, std::span<const std::size_t> labels, std::size_t classes) {
  std::vector<float> values(element_count({labels.size(), classes}));
  for (std::size_t b = 0; b < labels.size(); ++b) {
    require(labels[b] < classes, "label ", labels[b], " of sample ", b, ", expected less than ", classes);
    values[b * classes + labels[b]] = 1;
  }
  return Tensor::from(context, {labels.size(), classes}, values);
}

/// Mean cross-entropy over samples, -log softmax(logits)[label]: logits [B, Y], one-hot targets [B, Y] ->
/// [1]. Throws Error if the shapes differ or there is no sample or class.
inline Var cross_entropy(const Var& logits, const Var& targets) {
  require(logits.shape() == targets.shape(), "cross_entropy: logits ", logits.shape(), " and targets ",
          targets.shape());
  require(logits.size() > 0, "cross_entropy: logits ", logits.shape(),
          "; give at least one sample and one class");
  return affine(sum(log_softmax(logits) * targets), -1 / static_cast<double>(logits.dim(0)));
}

}  // namespace motiongan
