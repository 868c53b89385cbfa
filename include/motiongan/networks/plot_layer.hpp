// The plot layer of DVGAN's generators: combines text and noise into the input of a frame (Lin & Amer, eq. 4
// and 5).
#pragma once
#include "motiongan/nn/linear.hpp"

namespace motiongan {

/// out(ReLU(noise(z) + h_txt)) with size-1 convolutions: noise z [T, B, k] and text h_txt [B, k] give
/// [T, B, k].
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
