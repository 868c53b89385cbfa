// Tensors: round trips, views, asynchronous uploads.
#include <doctest/doctest.h>

#include <motiongan/ops/elementwise.hpp>
#include <motiongan/ops/layout.hpp>
#include <numeric>

namespace tensor_test {

using namespace motiongan;

namespace {

std::vector<double> counting(std::size_t n, double first = 0) {
  std::vector<double> values(n);
  std::iota(values.begin(), values.end(), first);
  return values;
}

}  // namespace

TEST_CASE("round trips in either precision and from either type" * doctest::test_suite("double")) {
  const std::vector<double> fine{0.1, -1e-30, 3e30, 1.0 / 3};
  std::vector<float> coarse(fine.begin(), fine.end());
  const Context floats, doubles({.precision = Precision::f64});
  CHECK(Tensor::from(doubles, {4}, fine).to_host<double>() == fine);
  CHECK(Tensor::from(doubles, {2, 2}, coarse).to_host() == coarse);
  CHECK(Tensor::from(floats, {4}, fine).to_host() == coarse);
  CHECK(Tensor::from(floats, {4}, coarse).to_host<double>() ==
        std::vector<double>(coarse.begin(), coarse.end()));
  CHECK(floats.real_size() == 4);
  CHECK(doubles.real_size() == 8);
}

TEST_CASE("shapes, reshape and views") {
  const Context context;
  const Tensor t = Tensor::from(context, {2, 3, 4}, counting(24));
  CHECK(t.size() == 24);
  CHECK(t.rank() == 3);
  CHECK(t.dim(1) == 3);
  CHECK_THROWS(t.dim(3));
  CHECK(to_string(t.shape()) == "[2, 3, 4]");
  CHECK(to_string(Shape{}) == "[]");
  CHECK(t.reshape({6, 4}).to_host<double>() == counting(24));
  CHECK_THROWS_WITH_AS(t.reshape({5, 5}), "cannot reshape [2, 3, 4] to [5, 5]", Error);

  const Tensor second = t.view(12, {3, 4});
  CHECK(second.offset() == 12);
  CHECK(second.to_host<double>() == counting(12, 12));
  const Tensor inner = second.view(4, {4});  // offsets in a view of a view are relative to the first view
  CHECK(inner.to_host<double>() == counting(4, 16));
  CHECK_THROWS_WITH_AS(second.view(10, {3}), "view of 3 elements from 10 does not fit [3, 4]", Error);
  CHECK_THROWS_AS(t.reshape({24}).view(25, {0}), Error);

  Tensor writable = inner;  // shares the data of t
  writable.write(std::span<const double>(counting(4, 100)));
  CHECK(t.to_host<double>()[15] == 15);
  CHECK(t.to_host<double>()[16] == 100);
  CHECK(t.to_host<double>()[19] == 103);
  CHECK(t.to_host<double>()[20] == 20);
}

TEST_CASE("wrong numbers of values are rejected") {
  const Context context;
  CHECK_THROWS_WITH_AS(Tensor::from(context, {2, 3}, counting(5)),
                       "5 values given for a tensor of shape [2, 3]", Error);
  CHECK_THROWS_AS(Tensor::from(context, {2}, counting(2)).item(), Error);
  CHECK(Tensor::from(context, {1}, counting(1, 7)).item() == 7);
  Indices three(context, 3);
  CHECK_THROWS_WITH_AS(three.write(std::vector<cl_int>{1}), "1 values given for 3 indices", Error);
}

TEST_CASE("round trips of integers; empty tensors") {
  const Context context;
  const std::vector<cl_int> values{-5, 0, 2'000'000'000};
  CHECK(Indices(context, values).to_host() == values);
  const Tensor none = Tensor::from(context, {0, 4}, std::vector<float>{});
  CHECK(none.to_host().empty());
  CHECK(Tensor().empty());
  CHECK_FALSE(none.empty());
}

TEST_CASE("uploads keep their data if the host's array changes afterwards") {
  // More consecutive writes from one array than the staging ring has slots, without waiting.
  const Context context;
  const std::size_t writes = 200, n = 5000;
  std::vector<Tensor> tensors;
  std::vector<float> values(n);
  for (std::size_t i = 0; i < writes; ++i) tensors.emplace_back(context, Shape{n});
  for (std::size_t i = 0; i < writes; ++i) {
    std::fill(values.begin(), values.end(), static_cast<float>(i));
    tensors[i].write(std::span<const float>(values));
  }
  std::fill(values.begin(), values.end(), -1.f);
  for (std::size_t i = 0; i < writes; ++i)
    CHECK(tensors[i].to_host() == std::vector<float>(n, static_cast<float>(i)));
}

TEST_CASE("kernels between uploads to one tensor see the right data") {
  const Context context;
  Tensor x(context, {256});
  std::vector<Var> seen;
  for (int i = 0; i < 200; ++i) {
    x.write(std::span<const float>(std::vector<float>(256, static_cast<float>(i))));
    seen.push_back(affine(Var::constant(x), 2));
  }
  for (std::size_t i = 0; i < seen.size(); ++i)
    CHECK(seen[i].value().to_host() == std::vector<float>(256, 2.f * static_cast<float>(i)));
}

TEST_CASE("copies of all lengths and offsets") {
  const Context context;
  for (std::size_t n : {1, 3, 4, 15, 16, 17, 33, 100}) {
    const Tensor from = Tensor::from(context, {n + 3}, counting(n + 3)), to = full(context, {n + 5}, -1);
    detail::copy_tensor(from.view(3, {n}), to.view(2, {n}));
    std::vector<double> expected(n + 5, -1);
    std::iota(expected.begin() + 2, expected.end() - 3, 3.0);
    CHECK(to.to_host<double>() == expected);
  }
}

}  // namespace tensor_test
