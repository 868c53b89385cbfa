// A Var is a tensor in a computation graph. Each operation records its inputs and a vector-Jacobian product,
// itself written in Vars, so that gradients can be differentiated again.
#pragma once
#include <atomic>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "motiongan/core/tensor.hpp"

namespace motiongan {

class Var;
struct Node;

/// Which inputs of an operation need a gradient; the others are skipped.
using Needs = std::vector<bool>;

/// Vector-Jacobian product: maps the gradient of the output to those of the inputs (an empty Var means zero).
using Vjp = std::function<std::vector<Var>(const Node& self, const Var& gradient, const Needs& needs)>;

/// A value in the graph; copies refer to the same value.
class Var {
 public:
  Var() = default;
  explicit Var(std::shared_ptr<Node> node) : node_(std::move(node)) {}

  /// A value without gradient.
  static Var constant(Tensor value);
  /// A leaf with gradient: a parameter, or an input to differentiate with respect to.
  static Var leaf(Tensor value);

  /// Whether it has no value at all, as one that was constructed without arguments.
  bool empty() const { return node_ == nullptr; }
  const Tensor& value() const;
  const Shape& shape() const { return value().shape(); }
  std::size_t dim(std::size_t i) const { return value().dim(i); }
  std::size_t size() const { return value().size(); }
  const Context& context() const { return value().context(); }
  /// Whether it is a leaf, or was computed from one while gradients were recorded.
  bool requires_grad() const;
  /// The same value without its graph; no gradient flows through it.
  Var detach() const { return constant(value()); }
  /// The only element. Throws Error if there are several.
  double item() const { return value().item(); }

  const std::shared_ptr<Node>& node() const { return node_; }

 private:
  friend struct Node;
  std::shared_ptr<Node> node_;
};

/// One value and the operation that computed it.
struct Node : std::enable_shared_from_this<Node> {
  Tensor value;                        ///< what was computed
  std::vector<Var> inputs;             ///< empty for leaves and constants
  Vjp vjp;                             ///< how gradients go on to the inputs
  const char* operation = "constant";  ///< the name in messages
  bool requires_grad = false;          ///< whether any input does, or it is a leaf
  unsigned frozen = 0;         ///< lifetimes of Frozen around it: grad() with respect to it is an error
  std::size_t id = next_id();  ///< increases with creation: a node's id is larger than its inputs'

  Node() = default;
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;
  ~Node() {
    // Iterative: recursion through an LSTM of many steps would overflow the stack. A node used twice is held
    // here twice and released with the second hold. Without memory for the list, what is left is released by
    // recursion after all.
    std::vector<std::shared_ptr<Node>> held;
    const auto take_inputs = [&held](Node& node) noexcept {
      try {
        for (Var& input : node.inputs)
          if (input.node_) held.push_back(std::move(input.node_));
      } catch (const std::bad_alloc&) {
      }
    };
    take_inputs(*this);
    while (!held.empty()) {
      const std::shared_ptr<Node> node = std::move(held.back());
      held.pop_back();
      if (node.use_count() == 1) take_inputs(*node);
    }
  }

 private:
  static std::size_t next_id() {
    static std::atomic<std::size_t> counter{0};
    return ++counter;
  }
};

inline const Tensor& Var::value() const {
  require(node_ != nullptr, "an empty Var has no value");
  return node_->value;
}
inline bool Var::requires_grad() const { return node_ && node_->requires_grad; }

inline Var Var::constant(Tensor value) {
  auto node = std::make_shared<Node>();
  node->value = std::move(value);
  return Var(std::move(node));
}
inline Var Var::leaf(Tensor value) {
  Var var = constant(std::move(value));
  var.node_->operation = "leaf";
  var.node_->requires_grad = true;
  return var;
}

namespace detail {
inline bool& recording() {
  thread_local bool on = true;
  return on;
}
}  // namespace detail

/// While an object of this class exists, operations of this thread record no graph.
class NoGrad {
 public:
  /// Stops recording until the object ends; with `off` false, changes nothing.
  explicit NoGrad(bool off = true) : before_(detail::recording()) { detail::recording() = before_ && !off; }
  ~NoGrad() { detail::recording() = before_; }
  NoGrad(const NoGrad&) = delete;
  NoGrad& operator=(const NoGrad&) = delete;

 private:
  bool before_;
};

/// The result of an operation: `value`, computed from `inputs` (some may be empty), with its vector-Jacobian
/// product. Records nothing if no input needs a gradient or NoGrad is in force.
inline Var record(const char* operation, std::vector<Var> inputs, Tensor value, Vjp vjp) {
  Var out = Var::constant(std::move(value));
  if (!detail::recording()) return out;
  for (const Var& input : inputs) out.node()->requires_grad |= input.requires_grad();
  if (!out.requires_grad()) return out;
  out.node()->operation = operation;
  out.node()->inputs = std::move(inputs);
  out.node()->vjp = std::move(vjp);
  return out;
}

}  // namespace motiongan
