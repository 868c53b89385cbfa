// The plot: what is to happen at one moment, from the text and noise (SPEC 2, "PlotLayer").
#pragma once
#include "motiongan/nn/linear.hpp"

namespace motiongan {

/// PlotLayer(h_txt, z) = out(ReLU(noise(z) + h_txt)), size-1 convolutions; z is [T, B, k], h_txt [B, k], the
/// result [T, B, k].
struct PlotLayer {
  Conv1d noise, out;

  PlotLayer() = default;
  PlotLayer(Initializer& init, std::size_t k) : noise(init, k, k), out(init, k, k) {}

  Var operator()(const Var& h_txt, const Var& z) const {
    return out(relu_of_sum(noise(z), reshape(h_txt, {1, h_txt.dim(0), h_txt.dim(1)})));
  }

  void list_parameters(ParameterList& list) {
    list.add_module("noise", noise);
    list.add_module("out", out);
  }
};

}  // namespace motiongan
