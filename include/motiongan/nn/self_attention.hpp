// Self-attention over the frames of a motion (Malek-Podjaski & Deligianni, eq. 1-3).
#pragma once
#include "motiongan/nn/linear.hpp"
#include "motiongan/ops/attention.hpp"

namespace motiongan {

/// y = gamma * out(o) + x, with o_j = sum over i of beta_ji value(x_i) and beta_ji = softmax over i of
/// query(x_i) . key(x_j). Query, key and value have C / 8 channels (rounded down, at least 1). gamma starts
/// at 0, so the layer is initially the identity.
struct SelfAttention {
  static constexpr std::size_t reduction = 8;
  Conv1d query, key, value, out;
  Var gamma;  ///< [1]

  SelfAttention() = default;
  SelfAttention(Initializer& init, std::size_t channels) {
    const std::size_t inner = std::max<std::size_t>(1, channels / reduction);
    query = Conv1d(init, channels, inner);
    key = Conv1d(init, channels, inner);
    value = Conv1d(init, channels, inner);
    out = Conv1d(init, inner, channels);
    gamma = init.constant({1}, 0);
  }

  /// Attention weights [B, T, T]: row j holds the weights of frame j over all frames i (see attention_map).
  Var map(const Var& x) const { return attention_map(query(x), key(x)); }

  /// [T, B, C] -> [T, B, C].
  Var operator()(const Var& x) const {
    const std::size_t inner = query.out_channels(), channels = x.dim(2);
    // One product for query, key and value; gamma scales the output weights, which are fewer than the
    // activations.
    const Var all = linear(x, concatenate({query.weight, key.weight, value.weight}, 1),
                           {.bias = concatenate({query.bias, key.bias, value.bias}, 0)});
    const auto part = [&](std::size_t i) { return slice(all, 2, i * inner, inner); };
    const Var mixed = attention_apply(attention_map(part(0), part(1)), part(2));
    return linear(mixed, out.weight * broadcast_to(gamma, out.weight.shape()),
                  {.bias = out.bias * broadcast_to(gamma, {channels}), .residual = x});
  }

  void list_parameters(ParameterList& list) {
    list.add_module("query", query);
    list.add_module("key", key);
    list.add_module("value", value);
    list.add_module("out", out);
    list.add("gamma", gamma);
  }
};

}  // namespace motiongan
