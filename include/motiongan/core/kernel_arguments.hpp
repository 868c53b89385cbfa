// The sizes and the arguments of a kernel launch.
#pragma once
#include <array>
#include <cstddef>
#include <limits>

#include "motiongan/core/driver.hpp"
#include "motiongan/core/program.hpp"

namespace motiongan {

/// A scalar kernel argument, converted to the Context's precision.
struct KernelReal {
  double value;
};

/// Global and local sizes of a launch. Local sizes are fixed per kernel: PoCL recompiles for each new one.
struct LaunchGrid {
  cl_uint dimensions;
  /// Work-items in all, and in a work-group; local[0] = 0: Context::group().
  std::array<std::size_t, 3> global, local;

  /// At least `n` work-items in one dimension, in work-groups of up to 64; kernels skip those past n.
  static LaunchGrid items(std::size_t n) { return {1, {(n + 63) / 64 * 64, 1, 1}, {0, 1, 1}}; }
  /// x * y * z work-groups of one work-item, for kernels that process one tile each.
  static LaunchGrid groups(std::size_t x, std::size_t y = 1, std::size_t z = 1) {
    return {3, {x, y, z}, {1, 1, 1}};
  }
};

namespace detail {

/// Sets the arguments of one launch, in order.
struct KernelArguments {
  cl_kernel kernel;
  Driver& driver;
  Precision precision;
  const char* name;
  cl_uint index = 0;

  template <class T>
  void set(const T& value) {
    driver.check(clSetKernelArg(kernel, index, sizeof value, &value), "clSetKernelArg", ": argument ", index,
                 " of kernel ", name);
    ++index;
  }
};

inline void add_argument(KernelArguments& to, KernelReal real) {
  if (to.precision == Precision::f64)
    to.set(static_cast<cl_double>(real.value));
  else
    to.set(static_cast<cl_float>(real.value));
}
inline void add_argument(KernelArguments& to, std::size_t value) {
  require(value <= std::numeric_limits<cl_uint>::max(), "kernel ", to.name, ": ", value,
          " does not fit 32 bits; use a smaller batch or fewer frames");
  to.set(static_cast<cl_uint>(value));
}
inline void add_argument(KernelArguments& to, cl_uint value) { to.set(value); }
inline void add_argument(KernelArguments& to, cl_int value) { to.set(value); }
inline void add_argument(KernelArguments& to, cl_mem value) { to.set(value); }

}  // namespace detail
}  // namespace motiongan
