// The matrix product against a plain loop on the host: sizes, transposes, strides, epilogues, both engines.
#include "gemm_problem.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <motiongan/core/bf16.hpp>

namespace gemm_test {

using namespace motiongan;
using namespace motiongan::test;

namespace {

/// Runs a plan and compares all of C's tensor, including the elements around C.
void check(Precision precision, const Plan& plan, GemmEngine engine, std::mt19937& random) {
  const Context& context = context_of(precision);
  const Problem problem = make(context, plan, random);
  gemm(context, problem.call, engine);
  const std::vector<double> ours = problem.call.c.to_host<double>(), reference = expected(problem);
  const double unit = precision == Precision::f64 ? 1e-13 : 1e-5;
  // Operands are in [-1, 1]: a sum, and its rounding error, grow with the square root of its length.
  const double allowed = unit * (1 + std::sqrt(static_cast<double>(plan.k * plan.segments)));
  std::size_t wrong = 0, first_wrong = 0;
  for (std::size_t e = 0; e < ours.size(); ++e)
    if (!(std::abs(ours[e] - reference[e]) <= (reference[e] == sentinel ? 0 : allowed)) && wrong++ == 0)
      first_wrong = e;
  CAPTURE(concat(problem.call));
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

TEST_CASE("native: all sizes of one dimension with small others, all transposes") {
  std::mt19937 random(1);
  for (const Precision precision : testing::precisions())
    for (const std::size_t size : sizes)
      for (int t = 0; t < 4; ++t)
        for (int dimension = 0; dimension < 3; ++dimension) {
          Plan plan{.m = 7, .n = 19, .k = 6, .a_transposed = t % 2 == 1, .b_transposed = t / 2 == 1};
          (dimension == 0 ? plan.m : dimension == 1 ? plan.n : plan.k) = size;
          check(precision, plan, GemmEngine::native, random);
        }
}

TEST_CASE("native: random combinations of all options") {
  std::mt19937 random(2);
  for (const Precision precision : testing::precisions())
    for (int i = 0; i < 200; ++i) check(precision, random_plan(random, 257), GemmEngine::native, random);
}

TEST_CASE("native: sums longer than a block, one and several segments") {
  std::mt19937 random(3);
  for (const Precision precision : testing::precisions())
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

// Few plans: CLBlast takes seconds to compile each kind of product on a CPU device.
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
  for (const Precision precision : testing::precisions())
    check(precision, Plan{.m = 12, .n = 20, .k = 31, .b_transposed = true, .extra_ld = 2, .relu = true},
          engine, random);
}

TEST_CASE("k = 0: C is the epilogue of its initial value") {
  std::mt19937 random(5);
  for (const GemmEngine engine : {GemmEngine::native, GemmEngine::clblast})
    for (const bool accumulate : {false, true}) {
      check(Precision::f32, Plan{.m = 5, .n = 35, .k = 0, .accumulate = accumulate, .bias = true}, engine,
            random);
      for (const Precision precision : testing::precisions())
        check(precision, Plan{.m = 5, .n = 35, .k = 0, .segments = 3, .accumulate = accumulate}, engine,
              random);
    }
  const Context& context = context_of(Precision::f32);
  GemmCall call{.m = 2, .n = 3, .k = 0, .c = Tensor(context, {2, 3}), .c_ld = 3};
  gemm(context, call);  // A and B may be missing
  CHECK(call.c.to_host<double>() == std::vector<double>(6, 0.0));
}

TEST_CASE("empty C: nothing is written") {
  std::mt19937 random(6);
  check(Precision::f32, Plan{.m = 0, .n = 4, .k = 3}, GemmEngine::native, random);
  check(Precision::f32, Plan{.m = 4, .n = 0, .k = 3}, GemmEngine::clblast, random);
}

TEST_CASE("a row's bits do not depend on the rows around it, the columns beside it, or the batch") {
  std::mt19937 random(7);
  for (const Precision precision : testing::precisions()) {
    const Context& context = context_of(precision);
    for (const std::size_t k : {37, 512, 1700})
      for (int t = 0; t < 4; ++t) {
        const Plan plan{.m = 203,
                        .n = 141,
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
            CAPTURE(concat(call));
            CHECK(equal);
          }
        GemmCall again = whole.call;
        again.c = start;
        gemm(context, again, GemmEngine::native);
        const std::vector<double> second = again.c.to_host<double>();
        CHECK(std::equal(second.begin() + call.c_offset, second.begin() + call.c_offset + 141,
                         all.begin() + call.c_offset));
      }
  }
}

TEST_CASE("a transposed copy of B gives the same bits, so weights can be transposed once for sampling") {
  std::mt19937 random(8);
  const Context& context = context_of(Precision::f32);
  const std::size_t n = 300, k = 257;
  const std::vector<double> b = random_values(random, n * k, Precision::f32);
  std::vector<double> turned(n * k);
  for (std::size_t p = 0; p < k; ++p)
    for (std::size_t j = 0; j < n; ++j) turned[j * k + p] = b[p * n + j];
  for (const std::size_t m : {1, 2, 9, 64}) {
    GemmCall call{.m = m, .n = n, .k = k, .c = Tensor(context, {m, n}), .a_ld = k, .b_ld = n, .c_ld = n};
    call.a = upload(context, random_values(random, m * k, Precision::f32), 0);
    call.b = upload(context, b, 3);
    GemmCall other = call;
    other.b = upload(context, turned, 0), other.b_ld = k, other.b_transposed = true;
    other.c = Tensor(context, {m, n});
    gemm(context, call, GemmEngine::native);
    gemm(context, other, GemmEngine::native);
    CHECK(call.c.to_host() == other.c.to_host());
  }
}

TEST_CASE("NaN propagates, also through the ReLU") {
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

TEST_CASE("invalid arguments are rejected, with the sizes") {
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
  refused([](GemmCall& g) { g.c = Tensor(Context(), {4, 5}); }, "another context");
}

}  // namespace

TEST_CASE("packing B changes no bit, whatever the size, and nothing around C") {
  std::mt19937 random(11);
  for (const Precision precision : testing::precisions()) {
    const Context& context = context_of(precision);
    for (int i = 0; i < 150; ++i) {
      Plan plan = random_plan(random, 257);
      if (i % 3 == 0) plan.m = 1 + static_cast<std::size_t>(i % 2);
      if (i % 4 == 0) plan.n = 1000 + static_cast<std::size_t>(i);  // enough panels for the single-row kernel
      if (i % 10 == 0) plan.k = 1600;                               // more than one packing block
      plan.a_transposed = false, plan.batch = 1;
      Problem problem = make(context, plan, random);
      CAPTURE(concat(problem.call));
      problem.call.b_in_16_bits = i % 2 == 1;
      if (problem.call.b_in_16_bits) round_to_bf16(problem.call.b);
      const std::vector<double> start = problem.call.c.to_host<double>();
      gemm(context, problem.call, GemmEngine::native);
      const std::vector<double> plain = problem.call.c.to_host<double>();
      problem.call.c.write(std::span<const double>(start));
      problem.call.b_panels = pack_b(context, problem.call, GemmEngine::native);
      gemm(context, problem.call, GemmEngine::native);
      CHECK(problem.call.c.to_host<double>() == plain);
    }
    GemmCall call = make(context, {.m = 4, .n = 5, .k = 6}, random).call;
    call.b_panels = pack_b(context, call, GemmEngine::native);
    CHECK(call.b_panels.empty() == context.wide());
    CHECK(pack_b(context, call, GemmEngine::clblast).empty());
    call.a_transposed = true, call.a_ld = 4;
    if (!context.wide()) CHECK_THROWS_AS(gemm(context, call), Error);
  }
}

TEST_CASE("the extra ReLU output of C, packed or not, on either engine, and nothing around it") {
  std::mt19937 random(13);
  for (const Precision precision : testing::precisions()) {
    const Context& context = context_of(precision);
    for (const std::size_t m : {1u, 30u, 131u})
      for (const std::size_t n : {1u, 19u, 32u, 256u, 1001u})
        for (const bool pack : {false, true})
          for (const GemmEngine engine : {GemmEngine::native, GemmEngine::clblast}) {
            GemmCall call = make(context, {.m = m, .n = n, .k = 7, .segments = 2, .bias = true}, random).call;
            call.rectified_offset = 3;
            call.rectified = Tensor::from(context, {m * n + 5}, std::vector<double>(m * n + 5, sentinel));
            if (pack) call.b_panels = pack_b(context, call, GemmEngine::native);
            gemm(context, call, engine);
            std::vector<double> expected(m * n + 5, sentinel);
            const std::vector<double> c = call.c.to_host<double>();
            for (std::size_t i = 0; i < m * n; ++i) expected[3 + i] = std::max(0.0, c[call.c_offset + i]);
            CAPTURE(concat(call));
            CHECK(call.rectified.to_host<double>() == expected);
          }
    GemmCall call = make(context, {.m = 4, .n = 5, .k = 6}, random).call;
    call.rectified = Tensor(context, {19});
    CHECK_THROWS_AS(gemm(context, call), Error);
  }
}

TEST_CASE("native: a transposed A with long rows, which is transposed first") {
  std::mt19937 random(12);
  for (const Precision precision : testing::precisions())
    for (const std::size_t m : {64u, 101u, 600u}) {
      Plan plan{.m = m, .n = 65, .k = 300, .a_transposed = true, .extra_ld = 513, .offset = 3};
      check(precision, plan, GemmEngine::native, random);
      plan.accumulate = plan.bias = true;
      check(precision, plan, GemmEngine::native, random);
    }
}

}  // namespace gemm_test
