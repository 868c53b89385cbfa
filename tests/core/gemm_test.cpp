// The matrix product against a plain loop on the host: sizes, transposes, strides, epilogues, both engines.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <motiongan/core/gemm.hpp>
#include <random>

using namespace motiongan;

namespace {

constexpr double sentinel = 12345;

Context& context_of(Precision precision) {
  static Context f32(ContextOptions{.precision = Precision::f32}),
      f64(ContextOptions{.precision = Precision::f64});
  return precision == Precision::f32 ? f32 : f64;
}

/// A call without its data: everything that a test varies.
struct Plan {
  std::size_t m = 1, n = 1, k = 1;
  bool a_transposed = false, b_transposed = false;
  std::size_t segments = 1, batch = 1;
  std::size_t extra_ld = 0;  ///< leading dimensions beyond the rows' length
  std::size_t offset = 0;    ///< elements before each matrix; also the views' start
  bool accumulate = false, bias = false, residual = false, relu = false;
};

/// A GemmCall on the device and what it is made of on the host.
struct Problem {
  GemmCall call;
  std::vector<double> a, b, c, bias, residual;
};

std::vector<double> random_values(std::mt19937& random, std::size_t n, Precision precision) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<double> values(n);
  for (double& v : values) {
    v = uniform(random);
    if (precision == Precision::f32) v = static_cast<float>(v);
  }
  return values;
}

/// A tensor that is a view into a larger one, so that the offsets of tensors count.
Tensor upload(const Context& context, const std::vector<double>& values, std::size_t shift) {
  Tensor whole(context, {values.size() + shift});
  Tensor view = whole.view(shift, {values.size()});
  view.write(std::span<const double>(values));
  return view;
}

Problem make(const Context& context, const Plan& plan, std::mt19937& random) {
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
    g.a_offset[s] = plan.offset + s * (plan.offset + 1);  // the segments' A overlap, as a convolution's do
    g.b_offset[s] = plan.offset + (g.segments - 1 - s) * g.batch * g.b_batch_stride;
  }
  g.c_offset = plan.offset + 5;
  problem.a = random_values(random, g.a_offset[g.segments - 1] + g.batch * g.a_batch_stride, precision);
  problem.b = random_values(random, g.b_offset[0] + g.batch * g.b_batch_stride, precision);
  problem.c.assign(g.c_offset + g.batch * g.c_batch_stride + 7, sentinel);
  const std::vector<double> start = random_values(random, g.batch * g.m * g.n, precision);
  // Without `accumulate` C starts as NaN: what it held must not matter.
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

/// C as it must be, in double.
std::vector<double> expected(const Problem& problem) {
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

/// Runs a plan and compares all of C's tensor, the elements around C included.
void check(Precision precision, const Plan& plan, GemmEngine engine, std::mt19937& random) {
  const Context& context = context_of(precision);
  const Problem problem = make(context, plan, random);
  gemm(context, problem.call, engine);
  const std::vector<double> ours = problem.call.c.to_host<double>(), reference = expected(problem);
  const double unit = precision == Precision::f64 ? 1e-13 : 1e-5;
  // Operands lie in [-1, 1]: the size of a sum, and of its rounding, goes with the root of its length.
  const double allowed = unit * (1 + std::sqrt(static_cast<double>(plan.k * plan.segments)));
  std::size_t wrong = 0, first_wrong = 0;
  for (std::size_t e = 0; e < ours.size(); ++e)
    if (!(std::abs(ours[e] - reference[e]) <= (reference[e] == sentinel ? 0 : allowed)) && wrong++ == 0)
      first_wrong = e;
  CAPTURE(detail::describe(problem.call));
  CAPTURE(static_cast<int>(precision));
  CAPTURE(plan.accumulate);
  CAPTURE(plan.bias);
  CAPTURE(plan.residual);
  CAPTURE(plan.relu);
  CAPTURE(first_wrong);
  CAPTURE(ours[first_wrong]);
  CAPTURE(reference[first_wrong]);
  CHECK(wrong == 0);
}

constexpr std::size_t sizes[] = {1, 2, 3, 5, 8, 11, 12, 13, 16, 17, 31, 32, 33, 64, 77, 93, 100, 257};

Plan random_plan(std::mt19937& random, std::size_t largest) {
  const auto pick = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  const auto size = [&] { return std::min(sizes[pick(std::size(sizes))], largest); };
  Plan plan;
  plan.m = size(), plan.n = size(), plan.k = size();
  plan.a_transposed = pick(2), plan.b_transposed = pick(2);
  plan.segments = pick(2) ? 1 : 1 + pick(4);
  plan.batch = pick(3) ? 1 : 1 + pick(4);
  plan.extra_ld = pick(2) * pick(20);
  plan.offset = pick(2) * pick(40);
  plan.accumulate = pick(2), plan.bias = pick(2), plan.residual = pick(2), plan.relu = pick(2);
  return plan;
}

TEST_CASE("native: every size of a dimension beside small ones, all transposes") {
  std::mt19937 random(1);
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const std::size_t size : sizes)
      for (int t = 0; t < 4; ++t)
        for (int dimension = 0; dimension < 3; ++dimension) {
          Plan plan{.m = 7, .n = 19, .k = 6, .a_transposed = t % 2 == 1, .b_transposed = t / 2 == 1};
          (dimension == 0 ? plan.m : dimension == 1 ? plan.n : plan.k) = size;
          check(precision, plan, GemmEngine::native, random);
        }
}

TEST_CASE("native: random combinations of everything") {
  std::mt19937 random(2);
  for (int i = 0; i < 400; ++i)
    check(i % 2 ? Precision::f32 : Precision::f64, random_plan(random, 257), GemmEngine::native, random);
}

TEST_CASE("native: sums longer than one block, one and several segments") {
  std::mt19937 random(3);
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const std::size_t k : {767, 768, 769, 1600, 2500})
      for (const std::size_t segments : {1, 3})
        for (int t = 0; t < 4; ++t)
          check(precision,
                Plan{.m = 21,
                     .n = 70,
                     .k = k,
                     .a_transposed = t % 2 == 1,
                     .b_transposed = t / 2 == 1,
                     .segments = segments,
                     .extra_ld = 3,
                     .accumulate = t == 1,
                     .bias = true,
                     .residual = t == 2,
                     .relu = t == 3},
                GemmEngine::native, random);
}

// Few plans: CLBlast compiles each kind of product for seconds on a CPU device.
TEST_CASE("CLBlast: transposes, strides, segments, batch, epilogue") {
  std::mt19937 random(4);
  const GemmEngine engine = GemmEngine::clblast;
  for (int t = 0; t < 4; ++t)
    for (const std::size_t m : {1, 13, 64})
      check(Precision::f32,
            Plan{.m = m,
                 .n = 33,
                 .k = 17,
                 .a_transposed = t % 2 == 1,
                 .b_transposed = t / 2 == 1,
                 .segments = 1 + static_cast<std::size_t>(t),
                 .extra_ld = m == 13 ? 3u : 0u,
                 .offset = m == 64 ? 9u : 0u,
                 .accumulate = t == 1,
                 .bias = m != 1,
                 .residual = m == 13,
                 .relu = t == 2},
            engine, random);
  check(Precision::f32, Plan{.m = 5, .n = 9, .k = 7, .segments = 3, .batch = 4, .offset = 2, .bias = true},
        engine, random);
  check(Precision::f64, Plan{.m = 12, .n = 20, .k = 31, .b_transposed = true, .extra_ld = 2, .relu = true},
        engine, random);
}

TEST_CASE("no terms: C is the epilogue of what it starts from") {
  std::mt19937 random(5);
  for (const GemmEngine engine : {GemmEngine::native, GemmEngine::clblast})
    for (const bool accumulate : {false, true}) {
      check(Precision::f32, Plan{.m = 5, .n = 35, .k = 0, .accumulate = accumulate, .bias = true}, engine,
            random);
      check(Precision::f64, Plan{.m = 5, .n = 35, .k = 0, .segments = 3, .accumulate = accumulate}, engine,
            random);
    }
  const Context& context = context_of(Precision::f32);
  GemmCall call{.m = 2, .n = 3, .k = 0, .c = Tensor(context, {2, 3}), .c_ld = 3};
  gemm(context, call);  // A and B need not exist
  CHECK(call.c.to_host<double>() == std::vector<double>(6, 0.0));
}

TEST_CASE("nothing to write: C stays as it is") {
  std::mt19937 random(6);
  check(Precision::f32, Plan{.m = 0, .n = 4, .k = 3}, GemmEngine::native, random);
  check(Precision::f32, Plan{.m = 4, .n = 0, .k = 3}, GemmEngine::clblast, random);
}

TEST_CASE("a row's bits do not depend on the rows around it, the columns beside it, or the batch") {
  std::mt19937 random(7);
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    const Context& context = context_of(precision);
    for (const std::size_t k : {37, 512, 1700})
      for (int t = 0; t < 4; ++t) {
        const Plan plan{.m = 203,
                        .n = 93,
                        .k = k,
                        .a_transposed = t % 2 == 1,
                        .b_transposed = t / 2 == 1,
                        .segments = k == 512 ? 3u : 1u,
                        .accumulate = t == 3,
                        .bias = true,
                        .relu = t == 1};
        const Problem whole = make(context, plan, random);
        GemmCall call = whole.call;
        const Tensor start = upload(context, whole.c, 0);
        gemm(context, call, GemmEngine::native);
        const std::vector<double> all = call.c.to_host<double>();
        for (const std::size_t rows : {1, 2, 3, 7, 8, 11, 64})
          for (const std::size_t row : {0, 1, 13, 100, 139}) {
            GemmCall alone = whole.call;
            alone.c = upload(context, whole.c, 0);
            alone.m = rows;
            for (std::size_t s = 0; s < 4; ++s)
              alone.a_offset[s] += call.a_transposed ? row : row * call.a_ld;
            alone.c_offset += row * call.c_ld;
            const bool fewer_columns = row == 13;
            if (fewer_columns) alone.n = 41, alone.bias = call.bias.view(0, {41});
            gemm(context, alone, GemmEngine::native);
            const std::vector<double> piece = alone.c.to_host<double>();
            bool equal = true;
            for (std::size_t i = 0; i < rows; ++i)
              for (std::size_t j = 0; j < alone.n; ++j) {
                const std::size_t e = alone.c_offset + i * call.c_ld + j;
                equal = equal && piece[e] == all[e];
              }
            CAPTURE(rows);
            CAPTURE(row);
            CAPTURE(detail::describe(call));
            CHECK(equal);
          }
        GemmCall again = whole.call;
        again.c = start;
        gemm(context, again, GemmEngine::native);
        const std::vector<double> second = again.c.to_host<double>();
        CHECK(std::equal(second.begin() + call.c_offset, second.begin() + call.c_offset + 93,
                         all.begin() + call.c_offset));
      }
  }
}

TEST_CASE("a NaN reaches the result, through the ReLU too") {
  const Context& context = context_of(Precision::f32);
  std::vector<float> a(6, 1.0f);
  a[4] = std::numeric_limits<float>::quiet_NaN();
  GemmCall call{.m = 2,
                .n = 33,
                .k = 3,
                .a = Tensor::from(context, {2, 3}, a),
                .b = Tensor::from(context, {3, 33}, std::vector<float>(99, -1.0f)),
                .c = Tensor(context, {2, 33}),
                .a_ld = 3,
                .b_ld = 33,
                .c_ld = 33,
                .relu = true};
  for (const GemmEngine engine : {GemmEngine::native, GemmEngine::clblast}) {
    gemm(context, call, engine);
    const std::vector<float> c = call.c.to_host();
    for (std::size_t j = 0; j < 33; ++j) {
      CHECK(c[j] == 0.0f);
      CHECK(std::isnan(c[33 + j]));
    }
  }
}

TEST_CASE("wrong arguments are refused with the sizes") {
  const Context& context = context_of(Precision::f32);
  const auto good = [&] {
    return GemmCall{.m = 4,
                    .n = 5,
                    .k = 6,
                    .a = Tensor(context, {4, 6}),
                    .b = Tensor(context, {6, 5}),
                    .c = Tensor(context, {4, 5}),
                    .a_ld = 6,
                    .b_ld = 5,
                    .c_ld = 5};
  };
  CHECK_NOTHROW(gemm(context, good()));
  const auto refused = [&](auto change, const char* word) {
    GemmCall call = good();
    change(call);
    try {
      gemm(context, call);
    } catch (const Error& error) {
      const std::string what = error.what();
      CAPTURE(what);
      CHECK(what.find(word) != std::string::npos);
      CHECK(what.find("m=") != std::string::npos);
      return;
    }
    FAIL_CHECK("accepted, though it should say: ", std::string(word));
  };
  refused([](GemmCall& g) { g.a_ld = 7; }, "A (4 rows of 6");
  refused([](GemmCall& g) { g.a_offset[0] = 1; }, "needs 25 elements");
  refused([](GemmCall& g) { g.segments = 2, g.a_offset[1] = 1; }, "needs 25 elements");
  refused([](GemmCall& g) { g.b_transposed = true, g.b_ld = 7; }, "B (5 rows of 6");
  refused([](GemmCall& g) { g.b = Tensor(); }, "B is empty");
  refused([](GemmCall& g) { g.c_ld = 4; }, "rows of C overlap");
  refused([](GemmCall& g) { g.c_offset = 1; }, "C (4 rows of 5");
  refused([](GemmCall& g) { g.segments = 0; }, "segments");
  refused([](GemmCall& g) { g.segments = 5; }, "segments");
  refused([](GemmCall& g) { g.batch = 2; }, "overlap in C");
  refused([](GemmCall& g) { g.batch = 2, g.c_batch_stride = 20; }, "C (4 rows of 5");
  refused([&](GemmCall& g) { g.bias = Tensor(context, {4}); }, "bias has shape [4]");
  refused([&](GemmCall& g) { g.residual = Tensor(context, {4, 5}), g.residual_ld = 6; }, "residual");
  refused([](GemmCall& g) { g.c = Tensor(context_of(Precision::f64), {4, 5}); }, "another context");
}

}  // namespace
