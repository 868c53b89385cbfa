// Random matrix products with all their options, and their reference result from a plain loop on the host.
#pragma once
#include <algorithm>
#include <limits>
#include <motiongan/core/gemm.hpp>
#include <random>

#include "../support/precision.hpp"

namespace motiongan::test {

/// Value of the elements around C, which must not change.
constexpr double sentinel = 12345;

using testing::context_of;

/// A call without its data: the options that a test varies.
struct Plan {
  std::size_t m = 1, n = 1, k = 1;
  bool a_transposed = false, b_transposed = false;
  std::size_t segments = 1, batch = 1;
  std::size_t extra_ld = 0;  ///< leading dimensions beyond the rows' length
  std::size_t offset = 0;    ///< elements before each matrix; also the views' start
  bool accumulate = false, bias = false, residual = false, relu = false;
};

/// A GemmCall on the device, and its data on the host.
struct Problem {
  GemmCall call;
  std::vector<double> a, b, c, bias, residual;
};

inline std::vector<double> random_values(std::mt19937& random, std::size_t n, Precision precision) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<double> values(n);
  for (double& v : values) {
    v = uniform(random);
    if (precision == Precision::f32) v = static_cast<float>(v);
  }
  return values;
}

/// A tensor that is a view of a larger one, to test tensor offsets.
inline Tensor upload(const Context& context, const std::vector<double>& values, std::size_t shift) {
  Tensor whole(context, {values.size() + shift});
  Tensor view = whole.view(shift, {values.size()});
  view.write(std::span<const double>(values));
  return view;
}

inline Problem make(const Context& context, const Plan& plan, std::mt19937& random) {
  const Precision precision = context.precision();
  Problem problem;
  GemmCall& g = problem.call;
  g.m = plan.m, g.n = plan.n, g.k = plan.k;
  g.a_transposed = plan.a_transposed, g.b_transposed = plan.b_transposed;
  g.segments = plan.segments, g.batch = plan.batch;
  g.accumulate = plan.accumulate, g.relu = plan.relu;
  const std::size_t a_rows = g.a_transposed ? g.k : g.m, b_rows = g.b_transposed ? g.n : g.k;
  g.a_ld = (g.a_transposed ? g.m : g.k) + plan.extra_ld;
  g.b_ld = (g.b_transposed ? g.k : g.n) + 2 * plan.extra_ld;
  g.c_ld = g.n + 3 * plan.extra_ld;
  g.a_batch_stride = a_rows * g.a_ld + plan.offset;
  g.b_batch_stride = b_rows * g.b_ld;
  g.c_batch_stride = g.m * g.c_ld + plan.offset;
  for (std::size_t s = 0; s < g.segments; ++s) {
    g.a_offset[s] = plan.offset + s * (plan.offset + 1);  // the segments of A overlap, as in a convolution
    g.b_offset[s] = plan.offset + (g.segments - 1 - s) * g.batch * g.b_batch_stride;
  }
  g.c_offset = plan.offset + 5;
  problem.a = random_values(random, g.a_offset[g.segments - 1] + g.batch * g.a_batch_stride, precision);
  problem.b = random_values(random, g.b_offset[0] + g.batch * g.b_batch_stride, precision);
  problem.c.assign(g.c_offset + g.batch * g.c_batch_stride + 7, sentinel);
  const std::vector<double> start = random_values(random, g.batch * g.m * g.n, precision);
  // Without `accumulate` C starts as NaN: its old contents must not matter.
  for (std::size_t z = 0; z < g.batch; ++z)
    for (std::size_t i = 0; i < g.m; ++i)
      for (std::size_t j = 0; j < g.n; ++j)
        problem.c[g.c_offset + z * g.c_batch_stride + i * g.c_ld + j] =
            plan.accumulate ? start[(z * g.m + i) * g.n + j] : std::numeric_limits<double>::quiet_NaN();
  g.a = upload(context, problem.a, plan.offset);
  g.b = upload(context, problem.b, 2 * plan.offset);
  g.c = upload(context, problem.c, 3 * plan.offset);
  if (plan.bias) {
    problem.bias = random_values(random, g.n, precision);
    g.bias = upload(context, problem.bias, plan.offset);
  }
  if (plan.residual) {
    g.residual_offset = plan.offset;
    g.residual_ld = g.n + plan.extra_ld;
    problem.residual = random_values(random, g.residual_offset + g.m * g.residual_ld, precision);
    g.residual = upload(context, problem.residual, plan.offset);
  }
  return problem;
}

/// The expected C, in double.
inline std::vector<double> expected(const Problem& problem) {
  const GemmCall& g = problem.call;
  std::vector<double> c = problem.c;
  for (std::size_t z = 0; z < g.batch; ++z)
    for (std::size_t i = 0; i < g.m; ++i)
      for (std::size_t j = 0; j < g.n; ++j) {
        double& at = c[g.c_offset + z * g.c_batch_stride + i * g.c_ld + j];
        double sum = g.accumulate ? at : 0;
        for (std::size_t s = 0; s < g.segments; ++s) {
          const double* a = problem.a.data() + g.a_offset[s] + z * g.a_batch_stride;
          const double* b = problem.b.data() + g.b_offset[s] + z * g.b_batch_stride;
          for (std::size_t p = 0; p < g.k; ++p)
            sum += a[g.a_transposed ? p * g.a_ld + i : i * g.a_ld + p] *
                   b[g.b_transposed ? j * g.b_ld + p : p * g.b_ld + j];
        }
        if (!g.bias.empty()) sum += problem.bias[j];
        if (!g.residual.empty()) sum += problem.residual[g.residual_offset + i * g.residual_ld + j];
        at = g.relu ? std::max(sum, 0.0) : sum;
      }
  return c;
}

}  // namespace motiongan::test
