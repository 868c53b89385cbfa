// Saves and loads parameters as safetensors, with the names and shapes of a PyTorch state_dict().
#pragma once
#include <optional>

#include "motiongan/io/safetensors.hpp"
#include "motiongan/nn/module.hpp"

namespace motiongan::io {

namespace detail {

/// [taps, out, in] <-> [out, in, taps]: moves the axis of size `taps` from front to back, or the reverse.
template <class T>
std::vector<T> move_taps(const std::vector<T>& values, std::size_t taps, bool to_back) {
  if (values.empty()) return {};
  const std::size_t rest = values.size() / taps;
  std::vector<T> out(values.size());
  for (std::size_t s = 0; s < taps; ++s)
    for (std::size_t i = 0; i < rest; ++i) {
      if (to_back)
        out[i * taps + s] = values[s * rest + i];
      else
        out[s * rest + i] = values[i * taps + s];
    }
  return out;
}

}  // namespace detail

/// A parameter's shape in files.
inline Shape file_shape(const NamedParameter& parameter) {
  const Shape& s = parameter.value->shape();
  return parameter.layout == ParameterLayout::convolution ? Shape{s[1], s[2], s[0]} : s;
}

/// The values of a device tensor with this parameter's layout (the parameter or its gradient), in file order.
inline std::vector<double> to_file_order(const NamedParameter& parameter, const Tensor& tensor) {
  std::vector<double> values = tensor.to_host<double>();
  return parameter.layout == ParameterLayout::convolution ? detail::move_taps(values, tensor.dim(0), true)
                                                          : values;
}

/// Adds every parameter to `file` as `prefix` + its name, in the context's precision, whatever its values.
inline void add_parameters(const std::vector<NamedParameter>& parameters, SafeTensors& file,
                           const std::string& prefix = "") {
  for (const NamedParameter& p : parameters) {
    const std::vector<double> values = to_file_order(p, p.value->value());
    file.tensors[prefix + p.name] =
        p.value->context().precision() == Precision::f64
            ? SafeTensor::of(file_shape(p), values)
            : SafeTensor::of(file_shape(p), std::vector<float>(values.begin(), values.end()));
  }
}

/// A value that is not finite, and the tensor that holds it.
struct NotFinite {
  std::string name;
  double value;
};

/// The first value among the floating-point tensors of `file` that is not finite.
inline std::optional<NotFinite> first_not_finite(const SafeTensors& file) {
  for (const auto& [name, tensor] : file.tensors) {
    if (tensor.dtype != "F32" && tensor.dtype != "F64") continue;
    for (const double v : tensor.as<double>())
      if (!std::isfinite(v)) return NotFinite{name, v};
  }
  return std::nullopt;
}

/// add_parameters() for a file that is to be loaded. Throws DivergedError, naming the parameter, if one holds
/// a value that is not finite.
inline void save_parameters(const std::vector<NamedParameter>& parameters, SafeTensors& file,
                            const std::string& prefix = "") {
  add_parameters(parameters, file, prefix);
  if (const auto found = first_not_finite(file))
    throw DivergedError(
        "the parameter \"", found->name, "\" holds ", found->value,
        ": training diverged; nothing is saved, resume from the last file with a lower learning rate");
}

/// Sets every parameter from `file`. Throws Error, starting with `where` and naming the tensor, if one is
/// missing, has another shape, is not of a floating-point type or holds a value that is not finite; then no
/// parameter has changed.
inline void load_parameters(const std::vector<NamedParameter>& parameters, const SafeTensors& file,
                            const std::string& where, const std::string& prefix = "") {
  std::vector<std::vector<double>> all;
  for (const NamedParameter& p : parameters) {
    const auto found = file.tensors.find(prefix + p.name);
    require(found != file.tensors.end(), where, ": the tensor \"", prefix + p.name, "\" of shape ",
            file_shape(p), " is missing; the file was saved from another model or with other options");
    require(found->second.shape == file_shape(p), where, ": the tensor \"", prefix + p.name, "\" has shape ",
            found->second.shape, ", expected ", file_shape(p),
            "; the file was saved from a model of another size");
    all.push_back(found->second.as<double>());
    for (double v : all.back())
      require(std::isfinite(v), where, ": the tensor \"", prefix + p.name, "\" holds ", v,
              "; the file is damaged or training diverged");
    if (p.layout == ParameterLayout::convolution)
      all.back() = detail::move_taps(all.back(), p.value->dim(0), false);
  }
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    Tensor place = parameters[i].value->value();
    place.write(std::span<const double>(all[i]));
  }
}

}  // namespace motiongan::io
