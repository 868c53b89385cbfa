// The parameters of a one-layer GRU, as in PyTorch.
#pragma once
#include <cmath>

#include "motiongan/nn/module.hpp"

namespace motiongan {

/// r, z = sigmoid(W_i x + b_i + W_h h + b_h), n = tanh(W_i x + b_i + r (W_h h + b_h)), h' = (1 - z) n + z h,
/// with the gates stacked in the order r, z, n. Every parameter is initialised with U(+-1/sqrt(k)).
/// gru_rollout runs it.
struct Gru {
  Var weight_ih, weight_hh, bias_ih, bias_hh;  ///< [3k, in], [3k, k], [3k], [3k]

  Gru() = default;
  Gru(Initializer& init, std::size_t in, std::size_t k) {
    const double bound = 1 / std::sqrt(static_cast<double>(k));
    const std::size_t gates = element_count({3, k});
    weight_ih = init.uniform({gates, in}, bound);
    weight_hh = init.uniform({gates, k}, bound);
    bias_ih = init.uniform({gates}, bound);
    bias_hh = init.uniform({gates}, bound);
  }

  std::size_t hidden() const { return weight_hh.dim(1); }

  void list_parameters(ParameterList& list) {
    list.add("weight_ih_l0", weight_ih);
    list.add("weight_hh_l0", weight_hh);
    list.add("bias_ih_l0", bias_ih);
    list.add("bias_hh_l0", bias_hh);
  }
};

}  // namespace motiongan
