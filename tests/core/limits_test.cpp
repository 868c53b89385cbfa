// Sizes that kernels, which count in 32 bits, or std::size_t cannot hold.
#include <doctest/doctest.h>

#include <limits>
#include <motiongan/nn/gru.hpp>
#include <motiongan/nn/lstm.hpp>
#include <motiongan/ops/matmul.hpp>

#include "../support/messages.hpp"

namespace limits_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

constexpr std::size_t huge = std::numeric_limits<std::size_t>::max(), quarter = std::size_t{1} << 62;

const Context& small() {
  static const Context context({.element_limit = 1000});
  return context;
}

}  // namespace

TEST_CASE("a tensor with more elements than kernels count is refused, with its sizes and what to lower") {
  CHECK_NOTHROW(Tensor(small(), {10, 100}));
  CHECK(
      message_of([] {
        Tensor(small(), {7, 11, 13});
      }) ==
      "a tensor of shape [7, 11, 13] has 1001 elements, kernels count up to 1000; use a smaller batch, fewer "
      "frames or a smaller hidden width");
  CHECK_NOTHROW(Indices(small(), 1000));
  CHECK(says(message_of([] { Indices(small(), 1001); }), "[1001] has 1001 elements"));
  // Results of operations are tensors too.
  const Var x = ones(small(), {20, 40}), row = ones(small(), {1, 800});
  CHECK(says(message_of([&] { upsample_nearest(x, 2); }), "shape [40, 40] has 1600"));
  CHECK(says(message_of([&] { broadcast_to(row, {2, 800}); }), "shape [2, 800] has 1600"));
  CHECK(says(message_of([&] { concatenate({x, x}, 1); }), "shape [20, 80] has 1600"));
  CHECK(says(message_of([&] { pad(x, 0, 0, 6); }), "shape [26, 40] has 1040"));
  CHECK(says(message_of([&] { matmul(x, x, true, false); }), "shape [40, 40] has 1600"));
  CHECK(says(message_of([] { random_normal(small(), {}, 8, 8, 16); }), "shape [8, 8, 16] has 1024"));
  Initializer init(small(), 1);
  CHECK(says(message_of([&] { Linear(init, 40, 40); }), "shape [40, 40] has 1600"));
}

TEST_CASE("the limit of the kernels") {
  static_assert(most_elements < std::numeric_limits<cl_uint>::max());
  const Context context({.memory_limit = quarter}), more({.element_limit = huge});
  CHECK(context.element_limit() == most_elements);
  CHECK(more.element_limit() == most_elements);
  CHECK(says(message_of([&] {
               Tensor(context, {2, most_elements / 2 + 1});
             }),
             "kernels count up to 4293918720; use a smaller batch"));
  Initializer init(context, 1);  // before it makes the values on the host
  CHECK(says(message_of([&] { Linear(init, std::size_t{1} << 31, std::size_t{1} << 31); }),
             "kernels count up"));
}

TEST_CASE("the number of elements does not wrap around") {
  const Context context;
  CHECK(element_count({}) == 1);
  CHECK(element_count({2, 3, 4}) == 24);
  CHECK(element_count({5, 0}) == 0);
  CHECK(element_count({1, huge}) == huge);
  for (const Shape& shape : {Shape{quarter, 4}, Shape{huge, 2}, Shape{quarter, 4, 0}, Shape{0, quarter, 4}}) {
    CHECK(message_of([&] { element_count(shape); }) ==
          concat("a tensor of shape ", shape,
                 " has more elements than fit 64 bits; use a smaller batch, fewer "
                 "frames or a smaller hidden width"));
    CHECK_THROWS_AS(Tensor(context, shape), Error);
    CHECK_THROWS_AS(Tensor(context, {0}).reshape(shape), Error);
    CHECK_THROWS_AS(Tensor(context, {0}).view(0, shape), Error);
  }
}

TEST_CASE("the number of gates does not wrap around") {
  Initializer init(Context(), 1);
  CHECK(says(message_of([&] { Lstm(init, 3, quarter, 1); }), "[4, 4611686018427387904] has more elements"));
  CHECK(says(message_of([&] { Gru(init, 3, quarter * 2); }), "[3, 9223372036854775808] has more elements"));
}

TEST_CASE("parts of a tensor do not wrap around") {
  const Context context;
  const Tensor t(context, {2, 3});
  CHECK_THROWS_WITH_AS(t.view(huge, {2}), "view of 2 elements from 18446744073709551615 does not fit [2, 3]",
                       Error);
  CHECK_THROWS_AS(t.view(7, {0}), Error);
  CHECK_THROWS_AS(t.view(2, {huge}), Error);
  CHECK(t.view(6, {0}).size() == 0);
  const Var x = ones(context, {2, 3});
  for (std::size_t axis : {0, 1}) {
    CHECK_THROWS_AS(slice(x, axis, huge, 2), Error);
    CHECK_THROWS_AS(slice(x, axis, 1, huge), Error);
    CHECK_THROWS_AS(pad(x, axis, huge, 0), Error);
    CHECK_THROWS_AS(pad(x, axis, 1, huge), Error);
    CHECK_THROWS_AS(pad(x, axis, huge - 1, 2), Error);
  }
  CHECK_THROWS_AS(upsample_nearest(x, quarter * 2), Error);
}

TEST_CASE("a matrix product does not wrap around") {
  const Context context;
  const Tensor t(context, {4, 4});
  const GemmCall good{
      .m = 2, .n = 2, .k = 2, .a = t, .b = t, .c = Tensor(context, {4}), .a_ld = 4, .b_ld = 4, .c_ld = 2};
  CHECK_NOTHROW(gemm(context, good));
  const auto refused = [&](auto change) {
    GemmCall call = good;
    change(call);
    return says(message_of([&] { gemm(context, call); }), "elements");
  };
  CHECK(refused([](GemmCall& g) { g.a_offset[0] = huge - 4; }));
  CHECK(refused([](GemmCall& g) { g.a_ld = huge; }));
  CHECK(refused([](GemmCall& g) { g.b_ld = quarter * 2, g.k = 3; }));
  CHECK(refused([](GemmCall& g) { g.c_offset = huge - 3; }));
  CHECK(refused([](GemmCall& g) { g.batch = 5, g.c_batch_stride = quarter; }));
  CHECK(refused([&](GemmCall& g) { g.residual = t, g.residual_offset = huge - 5, g.residual_ld = 4; }));
  CHECK(refused([&](GemmCall& g) { g.rectified = t, g.rectified_offset = huge - 3; }));
}

}  // namespace limits_test
