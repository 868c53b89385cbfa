// Modules own named parameters; the names are the keys of a PyTorch state_dict.
#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/autograd/grad.hpp"
#include "motiongan/core/bf16.hpp"
#include "motiongan/core/random.hpp"

namespace motiongan {

/// A parameter's layout on the device and in files.
enum class ParameterLayout {
  plain,       ///< as in PyTorch, on the device and in files
  convolution  ///< [taps, out, in] on the device (one matrix per tap), [out, in, taps] in files
};

/// A parameter of a network, under the name that it has in files.
struct NamedParameter {
  std::string name;
  Var* value = nullptr;                             ///< the network's own
  ParameterLayout layout = ParameterLayout::plain;  ///< how it differs from the file's shape
};

/// While an object of this class exists, this thread creates parameters of at most `most` elements in all:
/// before one more is allocated, Error is thrown, starting with `where`, the file that the options are from.
class ParameterLimit {
 public:
  ParameterLimit(std::size_t most, std::string where)
      : left_(most), where_(std::move(where)), outer_(std::exchange(current(), this)) {}
  ParameterLimit(const ParameterLimit&) = delete;
  ParameterLimit& operator=(const ParameterLimit&) = delete;
  ~ParameterLimit() { current() = outer_; }

  /// Counts a parameter that is about to be created.
  static void count(const Shape& shape) {
    if (current() != nullptr) current()->take(shape);
  }

 private:
  static ParameterLimit*& current() {
    thread_local ParameterLimit* limit = nullptr;
    return limit;
  }

  void take(const Shape& shape) {
    const std::size_t before = left_;
    for (std::size_t elements = 1; const std::size_t n : shape)
      require(!__builtin_mul_overflow(elements, n, &elements) && elements <= before, where_,
              ": the model's options ask for a parameter of shape ", shape,
              ", far more numbers than the file ",
              "holds; the file is damaged, or its options are those of another model");
    left_ -= element_count(shape);
  }

  std::size_t left_;
  std::string where_;
  ParameterLimit* outer_;
};

/// Creates parameters with random initial values. The random key of each contains its number in order of
/// creation: equal seeds and options give equal weights.
class Initializer {
 public:
  Initializer(const Context& context, std::uint64_t seed) : context_(context), seed_(seed) {}

  const Context& context() const { return context_; }

  /// Uniform in [-bound, bound]. Throws Error if the bound is not finite: that of a layer without inputs.
  Var uniform(Shape shape, double bound) {
    ParameterLimit::count(shape);
    require(std::isfinite(bound), "weights of shape ", shape,
            " cannot be initialised: a layer has no inputs, expected at least one channel");
    Tensor weights(context_, std::move(shape));  // first: it refuses what is too large
    if (context_.only_counts()) {  // the values of a large network would take seconds, and its memory
      ++count_;
      context_.write(weights.buffer(), 0, nullptr, weights.size() * context_.real_size());
      return Var::leaf(weights);
    }
    std::vector<float> values(weights.size());
    const RandomKey key{.seed = seed_, .stream = RandomStream::weights, .step = ++count_};
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = static_cast<float>(
          bound * (2 * (random_word(key, 0, static_cast<std::uint32_t>(i)) + 0.5) * 0x1p-32 - 1));
    weights.write(std::span<const float>(values));
    return Var::leaf(std::move(weights));
  }

  /// Standard normal.
  Var normal(std::size_t rows, std::size_t columns) {
    ParameterLimit::count({rows, columns});
    return Var::leaf(random_normal(context_,
                                   {.seed = seed_, .stream = RandomStream::weights, .step = ++count_}, 1,
                                   rows, columns)
                         .reshape({rows, columns}));
  }

  /// A parameter of equal numbers.
  Var constant(Shape shape, double value) {
    ParameterLimit::count(shape);
    return Var::leaf(full(context_, std::move(shape), value));
  }

 private:
  Context context_;
  std::uint64_t seed_;
  std::uint32_t count_ = 0;
};

/// Collects parameters; the names of a submodule's get its prefix and a dot.
class ParameterList {
 public:
  /// Adds a parameter, which must outlive the list.
  void add(const std::string& name, Var& value, ParameterLayout layout = ParameterLayout::plain) {
    items_.push_back({name, &value, layout});
  }

  /// Adds all parameters of a part, their names after "prefix.".
  template <class Module>
  void add_module(const std::string& prefix, Module& module) {
    ParameterList inner;
    module.list_parameters(inner);
    for (NamedParameter& p : inner.items_) items_.push_back({prefix + "." + p.name, p.value, p.layout});
  }

  const std::vector<NamedParameter>& items() const { return items_; }

 private:
  std::vector<NamedParameter> items_;
};

/// The named parameters of a module, any type with a member list_parameters(ParameterList&).
template <class Module>
std::vector<NamedParameter> named_parameters(Module& module) {
  ParameterList list;
  module.list_parameters(list);
  return list.items();
}

/// The values of the parameters, in order.
inline std::vector<Var> values_of(const std::vector<NamedParameter>& parameters) {
  std::vector<Var> values;
  for (const NamedParameter& p : parameters) values.push_back(*p.value);
  return values;
}

/// Rounds the values of all parameters to the nearest bfloat16.
inline void round_to_bf16(const std::vector<NamedParameter>& parameters) {
  for (const NamedParameter& p : parameters) round_to_bf16(p.value->value());
}

/// While an object of this class exists, grad() with respect to one of the parameters throws. For a network
/// through which another one is trained. Operations are recorded as always, so that a graph from this time
/// can be differentiated in full later; grad() computes only what its inputs need.
class Frozen {
 public:
  explicit Frozen(const std::vector<NamedParameter>& parameters) {
    for (const NamedParameter& p : parameters) {
      if (p.value->empty()) continue;
      nodes_.push_back(p.value->node());
      ++nodes_.back()->frozen;
    }
  }
  ~Frozen() {
    for (const auto& node : nodes_) --node->frozen;
  }
  Frozen(const Frozen&) = delete;
  Frozen& operator=(const Frozen&) = delete;

 private:
  std::vector<std::shared_ptr<Node>> nodes_;
};

/// Total number of elements of all parameters.
inline std::size_t parameter_count(const std::vector<NamedParameter>& parameters) {
  std::size_t n = 0;
  for (const NamedParameter& p : parameters) n += p.value->size();
  return n;
}

}  // namespace motiongan
