// Modules own named parameters; the names are the keys of a PyTorch state_dict.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "motiongan/autograd/grad.hpp"
#include "motiongan/core/random.hpp"

namespace motiongan {

/// A parameter's layout on the device and in files.
enum class ParameterLayout {
  plain,       ///< as in PyTorch, on the device and in files
  convolution  ///< [taps, out, in] on the device (one matrix per tap), [out, in, taps] in files
};

struct NamedParameter {
  std::string name;
  Var* value = nullptr;
  ParameterLayout layout = ParameterLayout::plain;
};

/// Creates parameters with random initial values. The random key of each contains its number in order of
/// creation: equal seeds and options give equal weights.
class Initializer {
 public:
  Initializer(const Context& context, std::uint64_t seed) : context_(context), seed_(seed) {}

  const Context& context() const { return context_; }

  /// Uniform in [-bound, bound].
  Var uniform(Shape shape, double bound) {
    if (context_.only_counts()) {  // the values of a large network would take seconds, and its memory
      ++count_;
      const Tensor counted(context_, std::move(shape));
      context_.write(counted.buffer(), 0, nullptr, counted.size() * context_.real_size());
      return Var::leaf(counted);
    }
    std::vector<float> values(element_count(shape));
    const RandomKey key{.seed = seed_, .stream = RandomStream::weights, .step = ++count_};
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = static_cast<float>(
          bound * (2 * (random_word(key, 0, static_cast<std::uint32_t>(i)) + 0.5) * 0x1p-32 - 1));
    return Var::leaf(Tensor::from(context_, std::move(shape), values));
  }

  /// Standard normal.
  Var normal(std::size_t rows, std::size_t columns) {
    return Var::leaf(random_normal(context_,
                                   {.seed = seed_, .stream = RandomStream::weights, .step = ++count_}, 1,
                                   rows, columns)
                         .reshape({rows, columns}));
  }

  Var constant(Shape shape, double value) { return Var::leaf(full(context_, std::move(shape), value)); }

 private:
  Context context_;
  std::uint64_t seed_;
  std::uint32_t count_ = 0;
};

/// Collects parameters; the names of a submodule's get its prefix and a dot.
class ParameterList {
 public:
  void add(const std::string& name, Var& value, ParameterLayout layout = ParameterLayout::plain) {
    items_.push_back({name, &value, layout});
  }

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

inline std::vector<Var> values_of(const std::vector<NamedParameter>& parameters) {
  std::vector<Var> values;
  for (const NamedParameter& p : parameters) values.push_back(*p.value);
  return values;
}

/// While an object of this class exists, the parameters are constants: no gradient flows to them, and grad()
/// with respect to one throws. For a network through which another one is trained.
class Frozen {
 public:
  explicit Frozen(const std::vector<NamedParameter>& parameters) {
    for (const NamedParameter& p : parameters) {
      if (!p.value->requires_grad()) continue;  // already frozen
      nodes_.push_back(p.value->node());
      nodes_.back()->requires_grad = false;
    }
  }
  ~Frozen() {
    for (const auto& node : nodes_) node->requires_grad = true;
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
