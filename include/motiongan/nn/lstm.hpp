// Multi-layer LSTM and embedding, as in PyTorch.
#pragma once
#include "motiongan/nn/linear.hpp"
#include "motiongan/ops/lstm.hpp"

namespace motiongan {

/// A lookup table [rows, channels], initialised with N(0, 1): word ids [n] -> [n, channels].
struct Embedding {
  Var weight;

  Embedding() = default;
  Embedding(Initializer& init, std::size_t rows, std::size_t channels)
      : weight(init.normal(rows, channels)) {}
  /// Words [n] -> [n, channels].
  Var operator()(const Indices& words) const { return gather_rows(weight, words); }
  void list_parameters(ParameterList& list) { list.add("weight", weight); }
};

/// Hidden state h and cell state c of every layer, [B, k] each; empty means zeros.
struct LstmState {
  std::vector<Var> h, c;
};

/// Stacked LSTM layers with gate order i, f, g, o. Every parameter is initialised with U(+-1/sqrt(k)).
struct Lstm {
  /// Weights and biases of a layer, the gates in PyTorch's order.
  struct Layer {
    Var weight_ih, weight_hh, bias_ih, bias_hh;  ///< [4k, in], [4k, k], [4k], [4k]
  };
  std::vector<Layer> layers;  ///< the first reads the input

  Lstm() = default;
  Lstm(Initializer& init, std::size_t in, std::size_t k, std::size_t layer_count) {
    const double bound = 1 / std::sqrt(static_cast<double>(k));
    const std::size_t gates = element_count({4, k});
    for (std::size_t l = 0; l < layer_count; ++l) {
      const Var ih = init.uniform({gates, l == 0 ? in : k}, bound), hh = init.uniform({gates, k}, bound);
      const Var bias_ih = init.uniform({gates}, bound), bias_hh = init.uniform({gates}, bound);
      layers.push_back({ih, hh, bias_ih, bias_hh});
    }
  }

  std::size_t hidden() const { return layers.at(0).weight_hh.dim(1); }

  /// All states of every layer, each [2, T, B, k] (h, then c). x is [T, B, in]; `state` is the initial state
  /// (empty: zeros); for `lengths` see lstm_layer.
  std::vector<Var> operator()(const Var& x, const Indices& lengths = {}, const LstmState& state = {}) const {
    std::vector<Var> states;
    Var input = x;
    for (std::size_t l = 0; l < layers.size(); ++l) {
      const Layer& layer = layers[l];
      const Var zero = state.h.empty() ? zeros(x.context(), {x.dim(1), hidden()}) : Var();
      const Var gates = linear(input, layer.weight_ih, {.bias = layer.bias_ih + layer.bias_hh});
      states.push_back(lstm_layer(gates, layer.weight_hh, state.h.empty() ? zero : state.h[l],
                                  state.c.empty() ? zero : state.c[l], lengths));
      if (l + 1 < layers.size()) input = hidden_states(states.back());
    }
    return states;
  }

  /// Continues from `state` (empty: zeros) over x [T, B, in] and updates it to the state after the last
  /// frame. Returns h of the last layer, [T, B, k].
  Var advance(const Var& x, LstmState& state) const {
    const std::vector<Var> states = (*this)(x, {}, state);
    state = {};
    for (const Var& of_layer : states) {
      state.h.push_back(last_state(of_layer, 0));
      state.c.push_back(last_state(of_layer, 1));
    }
    return hidden_states(states.back());
  }

  void list_parameters(ParameterList& list) {
    for (std::size_t l = 0; l < layers.size(); ++l) {
      const std::string suffix = "_l" + std::to_string(l);
      list.add("weight_ih" + suffix, layers[l].weight_ih);
      list.add("weight_hh" + suffix, layers[l].weight_hh);
      list.add("bias_ih" + suffix, layers[l].bias_ih);
      list.add("bias_hh" + suffix, layers[l].bias_hh);
    }
  }
};

}  // namespace motiongan
