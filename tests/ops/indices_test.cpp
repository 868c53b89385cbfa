// Indices outside of what they count are errors, without waiting for the device.
#include <doctest/doctest.h>

#include <limits>
#include <motiongan/core/random.hpp>
#include <motiongan/ops/cross_entropy.hpp>
#include <motiongan/ops/lstm.hpp>

#include "../support/check_grads.hpp"
#include "../support/messages.hpp"

namespace indices_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

constexpr cl_int largest = std::numeric_limits<cl_int>::max();

Indices indices(const std::vector<cl_int>& values) { return {double_context(), values}; }
Var rows(Shape shape) { return ones(double_context(), std::move(shape)); }

}  // namespace

TEST_CASE("gather_rows: the error names the index, its place and what was expected" *
          doctest::test_suite("double")) {
  const Var table = rows({3, 2});
  CHECK(message_of([&] {
          gather_rows(table, indices({0, 2, 3, 1}));
        }) == "gather_rows: index 3 at place 2 of 4, expected 0 to 2");
  CHECK(message_of([&] {
          gather_rows(table, indices({0, 2, -1, 1}));
        }) == "gather_rows: index -1 at place 2 of 4, expected 0 to 2");
  CHECK(message_of([&] {
          gather_rows(rows({0, 2}), indices({0}));
        }) == "gather_rows: index 0 at place 0 of 1, expected none");
  CHECK(says(message_of([&] { gather_rows(table, indices({largest})); }), "index 2147483647 at place 0"));
  CHECK(gather_rows(table, indices({0, 2, 2})).shape() == Shape{3, 2});
  CHECK(says(message_of([&] { gather_rows(rows({3}), indices({0})); }), "a table [3], expected"));
}

TEST_CASE("checking an index does not wait for the device" * doctest::test_suite("double")) {
  const Indices index = indices({2, 0});
  const auto& now = double_context().statistics();
  const std::size_t reads = now.reads;
  gather_rows(rows({3, 2}), index);
  CHECK_THROWS_AS(gather_rows(rows({2, 2}), index), Error);
  CHECK(now.reads == reads);
}

TEST_CASE("the range follows the last values, in every copy" * doctest::test_suite("double")) {
  Indices index(double_context(), 2);
  const Indices copy = index;
  const Var table = rows({5, 2});
  CHECK(says(message_of([&] { gather_rows(table, index); }), "the indices have no values yet; write() them"));
  index.write(std::vector<cl_int>{4, 7});
  CHECK_THROWS_AS(gather_rows(table, copy), Error);
  index.write(std::vector<cl_int>{4, 3});
  CHECK_NOTHROW(gather_rows(table, copy));
  index.set_range(0, 9);
  CHECK_THROWS_AS(gather_rows(table, copy), Error);
}

TEST_CASE("indices drawn on the device have a known range" * doctest::test_suite("double")) {
  const Indices drawn = random_integers(double_context(), {.seed = 1}, 4, -2, 5);
  CHECK(message_of([&] {
          gather_rows(rows({3, 2}), drawn);
        }) == "gather_rows: indices drawn from -2 to 2, expected 0 to 2");
  const Indices fits = random_integers(double_context(), {.seed = 1}, 4, 0, 3);
  CHECK_NOTHROW(gather_rows(rows({3, 2}), fits));
  CHECK_THROWS_AS(gather_rows(rows({2, 2}), fits), Error);
  CHECK(says(message_of([] { random_integers(double_context(), {}, 4, 0, 0); }),
             "random_integers: 0 integers"));
  CHECK_NOTHROW(random_integers(double_context(), {}, 4, largest, 1));
  CHECK_THROWS_AS(random_integers(double_context(), {}, 4, largest, 2), Error);
  CHECK_THROWS_AS(random_integers(double_context(), {}, 4, 0, std::size_t{1} << 40), Error);
}

TEST_CASE("scatter_add_rows" * doctest::test_suite("double")) {
  CHECK(message_of([&] {
          scatter_add_rows(rows({3, 2}), indices({0, 5, 1}), 5);
        }) == "scatter_add_rows: index 5 at place 1 of 3, expected 0 to 4");
  CHECK(message_of([&] {
          scatter_add_rows(rows({4, 2}), indices({0, 4, 1}), 5);
        }) == "scatter_add_rows: 3 indices for rows [4, 2]");
}

TEST_CASE("shift_frames takes any offset whose frame number fits an int" * doctest::test_suite("double")) {
  const Var x = rows({3, 2, 1});
  const Var far = shift_frames(x, indices({1'000'000'000, -1'000'000'000}), 3, {.outside = 7});
  CHECK(far.value().to_host() == std::vector<float>(6, 7));
  for (const cl_int offset : {largest, -largest, std::numeric_limits<cl_int>::min()})
    CHECK(
        says(message_of([&] {
               shift_frames(x, indices({0, offset}), 3, {.first = 5});
             }),
             concat("shift_frames: index ", offset, " at place 1 of 2, expected -2147483639 to 2147483639")));
}

TEST_CASE("lengths of an LSTM's samples" * doctest::test_suite("double")) {
  const Var gates = rows({3, 2, 4}), weights = rows({4, 1}), first = rows({2, 1});
  const auto message = [&](const std::vector<cl_int>& lengths) {
    return message_of([&] { lstm_layer(gates, weights, first, first, indices(lengths)); });
  };
  CHECK(message({0, 3}) == "no error");
  CHECK(message({1, 4}) == "lstm_layer, lengths: index 4 at place 1 of 2, expected 0 to 3");
  CHECK(message({-1, 3}) == "lstm_layer, lengths: index -1 at place 0 of 2, expected 0 to 3");
  CHECK(message({1}) == "lstm_layer: 1 lengths for 2 samples");
}

TEST_CASE("first frames of noise, one per sample" * doctest::test_suite("double")) {
  CHECK(says(message_of([] {
               random_normal(double_context(), {}, 2, 3, 4, indices({1, 2}));
             }),
             "random_normal: 2 first frames for 3 samples"));
}

TEST_CASE("labels" * doctest::test_suite("double")) {
  CHECK(says(message_of([] {
               one_hot(double_context(), std::vector<std::size_t>{0, 3}, 3);
             }),
             "label 3 of sample 1, expected less than 3"));
}

}  // namespace indices_test
