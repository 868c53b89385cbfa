// Differentiable reshape.
#pragma once
#include "motiongan/autograd/var.hpp"

namespace motiongan {

/// The same elements with another shape. Throws Error if the sizes differ.
inline Var reshape(const Var& x, Shape shape) {
  return record("reshape", {x}, x.value().reshape(std::move(shape)),
                [](const Node& self, const Var& g, const Needs&) -> std::vector<Var> {
                  return {reshape(g, self.inputs[0].shape())};
                });
}

}  // namespace motiongan
