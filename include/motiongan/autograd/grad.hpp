// Reverse-mode differentiation of any order: the backward pass can itself be recorded.
#pragma once
#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include "motiongan/autograd/arithmetic.hpp"

namespace motiongan {

/// Options of grad().
struct GradOptions {
  bool create_graph = false;  ///< record the backward pass, so that the gradients can be differentiated again
};

namespace detail {
/// A gradient that does not depend on any variable, such as that of a linear function, as a leaf: it can be
/// differentiated again, with zero as its derivative.
inline Var differentiable(const Var& gradient) {
  return recording() && !gradient.requires_grad() ? Var::leaf(gradient.value()) : gradient;
}
}  // namespace detail

/// Gradients of sum_i <outputs[i], seeds[i]> with respect to each of `inputs`; zero for an input that no
/// output depends on. Only branches that lead to `inputs` are computed. An empty seed means ones (outputs are
/// usually scalars). Throws Error if an output or an input is a constant, an input is Frozen or a seed's
/// shape is not that of its output.
inline std::vector<Var> grad(const std::vector<Var>& outputs, const std::vector<Var>& seeds,
                             const std::vector<Var>& inputs, GradOptions options = {}) {
  require(outputs.size() == seeds.size(), "grad: ", outputs.size(), " outputs but ", seeds.size(), " seeds");
  for (std::size_t i = 0; i < outputs.size(); ++i)
    require(outputs[i].requires_grad(), "grad: output ", i, " of shape ", outputs[i].shape(),
            " is a constant: it was computed from constants, detached or under NoGrad; compute it from a "
            "Var::leaf outside of NoGrad");
  const NoGrad scope(!options.create_graph);

  // Nodes created before the oldest input cannot depend on any input.
  std::size_t oldest = static_cast<std::size_t>(-1);
  std::unordered_set<const Node*> wanted;
  for (const Var& input : inputs) {
    require(input.requires_grad(), "grad: an input of shape ", input.shape(),
            " is a constant; make it with Var::leaf or compute it from one");
    require(input.node()->frozen == 0, "grad: an input of shape ", input.shape(),
            " is frozen; end the lifetime of Frozen first, or leave this input out");
    wanted.insert(input.node().get());
    oldest = std::min(oldest, input.node()->id);
  }

  // Reachable nodes, newest first: every node comes before its inputs.
  std::vector<const Node*> order, pending;
  std::unordered_map<const Node*, bool> leads;  // whether a path leads to an input
  const auto visit = [&](const Var& var) {
    if (!var.requires_grad() || var.node()->id < oldest) return;
    if (leads.emplace(var.node().get(), false).second) pending.push_back(var.node().get());
  };
  for (const Var& output : outputs) visit(output);
  while (!pending.empty()) {
    const Node* node = pending.back();
    pending.pop_back();
    order.push_back(node);
    for (const Var& input : node->inputs) visit(input);
  }
  std::sort(order.begin(), order.end(), [](const Node* a, const Node* b) { return a->id > b->id; });
  const auto leads_on = [&leads](const Var& var) {
    if (!var.requires_grad()) return false;
    const auto found = leads.find(var.node().get());
    return found != leads.end() && found->second;
  };
  std::reverse(order.begin(), order.end());  // oldest first, so that a node's inputs are known before it
  for (const Node* node : order)
    leads[node] = wanted.contains(node) || std::any_of(node->inputs.begin(), node->inputs.end(), leads_on);
  std::reverse(order.begin(), order.end());

  std::unordered_map<const Node*, Var> gradients;
  const auto add = [&gradients](const Node* node, const Var& g) {
    const auto [place, fresh] = gradients.emplace(node, g);
    if (!fresh) place->second = place->second + g;
  };
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (!leads_on(outputs[i])) continue;
    const Var seed = seeds[i].empty() ? ones(outputs[i].context(), outputs[i].shape()) : seeds[i];
    require(seed.shape() == outputs[i].shape(), "grad: the seed is ", seed.shape(), ", the output ",
            outputs[i].shape());
    add(outputs[i].node().get(), seed);
  }
  for (const Node* node : order) {
    const auto found = gradients.find(node);
    if (found == gradients.end() || !node->vjp) continue;
    Needs needs;
    bool any = false;
    for (const Var& input : node->inputs) {
      needs.push_back(leads_on(input));
      any = any || needs.back();
    }
    if (!any) continue;
    const Var g = found->second;
    if (!wanted.contains(node)) gradients.erase(found);  // frees its buffer for reuse
    const std::vector<Var> of_inputs = node->vjp(*node, g, needs);
    for (std::size_t i = 0; i < of_inputs.size(); ++i) {
      if (!needs[i] || of_inputs[i].empty()) continue;
      require(of_inputs[i].shape() == node->inputs[i].shape(), "gradient of ", node->operation, ", input ", i,
              ", has shape ", of_inputs[i].shape(), ", expected ", node->inputs[i].shape());
      add(node->inputs[i].node().get(), of_inputs[i]);
    }
  }
  std::vector<Var> result;
  for (const Var& input : inputs) {
    const auto found = gradients.find(input.node().get());
    result.push_back(detail::differentiable(
        found != gradients.end() ? found->second : zeros(input.context(), input.shape())));
  }
  return result;
}

/// Gradients of the sum of `output` with respect to each of `inputs`.
inline std::vector<Var> grad(const Var& output, const std::vector<Var>& inputs, GradOptions options = {}) {
  return grad(std::vector<Var>{output}, std::vector<Var>{Var()}, inputs, options);
}

}  // namespace motiongan
