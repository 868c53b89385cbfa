// PyTorch's LSTM of several layers, and its Embedding.
#pragma once
#include "motiongan/nn/linear.hpp"
#include "motiongan/ops/lstm.hpp"

namespace motiongan {

/// A table of rows, N(0, 1) at first: words [n] -> [n, channels].
struct Embedding {
  Var weight;

  Embedding() = default;
  Embedding(Initializer& init, std::size_t rows, std::size_t channels)
      : weight(init.normal(rows, channels)) {}
  Var operator()(const Indices& words) const { return gather_rows(weight, words); }
  void list_parameters(ParameterList& list) { list.add("weight", weight); }
};

/// Layers of LSTM, gate order i, f, g, o; every weight U(+-1/sqrt(k)).
struct Lstm {
  struct Layer {
    Var weight_ih, weight_hh, bias_ih, bias_hh;  // [4k, in], [4k, k], [4k], [4k]
  };
  std::vector<Layer> layers;

  Lstm() = default;
  Lstm(Initializer& init, std::size_t in, std::size_t k, std::size_t layer_count) {
    const double bound = 1 / std::sqrt(static_cast<double>(k));
    for (std::size_t l = 0; l < layer_count; ++l) {
      const Var ih = init.uniform({4 * k, l == 0 ? in : k}, bound), hh = init.uniform({4 * k, k}, bound);
      const Var bias_ih = init.uniform({4 * k}, bound), bias_hh = init.uniform({4 * k}, bound);
      layers.push_back({ih, hh, bias_ih, bias_hh});
    }
  }

  std::size_t hidden() const { return layers.at(0).weight_hh.dim(1); }

  /// All states of every layer, each [2, T, B, k] (h, then c), from zero states. x is [T, B, in]; lengths as
  /// lstm_layer.
  std::vector<Var> operator()(const Var& x, const Indices& lengths = {}) const {
    std::vector<Var> states;
    Var input = x;
    for (const Layer& layer : layers) {
      const Var first = zeros(x.context(), {x.dim(1), hidden()});
      const Var w = reshape(layer.weight_ih, {1, layer.weight_ih.dim(0), layer.weight_ih.dim(1)});
      const Var gates = taps(input, w, {0}, input.dim(0), false, {.bias = layer.bias_ih + layer.bias_hh});
      states.push_back(lstm_layer(gates, layer.weight_hh, first, first, lengths));
      if (states.size() < layers.size()) input = hidden_states(states.back());
    }
    return states;
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
