// Rounding to bfloat16.
#include <doctest/doctest.h>

#include <bit>
#include <limits>
#include <motiongan/core/bf16.hpp>
#include <random>

#include "../support/precision.hpp"

namespace bf16_test {

using namespace motiongan;

namespace {

/// The nearest of the two neighbours with 16 low bits of 0, and of two that are as near the even one.
float nearest(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  const float below = std::bit_cast<float>(bits & 0xffff0000u),
              above = std::bit_cast<float>((bits & 0xffff0000u) + 0x10000u);
  const double to_below = std::abs(static_cast<double>(x) - below),
               to_above = std::abs(static_cast<double>(above) - x);
  if (to_below != to_above) return to_below < to_above ? below : above;
  return (bits >> 16) % 2 == 0 ? below : above;
}

}  // namespace

TEST_CASE("values become the nearest bfloat16, and stay as they are after that") {
  std::mt19937 random(1);
  std::vector<float> values{0.0f, -0.0f, 1.0f, 1.00390625f, 1.01171875f, -1.00390625f, 3.0e38f, 1e-38f};
  for (int i = 0; i < 1000; ++i) values.push_back(std::normal_distribution<float>(0, 1)(random));
  for (int i = 0; i < 1000; ++i) {  // halfway between two of them
    const auto bits = static_cast<std::uint32_t>(random());
    const float value = std::bit_cast<float>((bits & 0xbfff0000u) | 0x8000u);
    values.push_back(value);
  }
  for (const Precision precision : testing::precisions()) {
    const Context context(ContextOptions{.precision = precision});
    const Tensor x = Tensor::from(context, {values.size()}, values);
    round_to_bf16(x);
    const std::vector<float> rounded = x.to_host();
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < values.size(); ++i) wrong += rounded[i] != nearest(values[i]);
    CHECK(wrong == 0);
    round_to_bf16(x);
    CHECK(x.to_host() == rounded);
  }
}

TEST_CASE("part of a tensor is rounded, and nothing around it") {
  const Context context;
  const std::vector<float> values(100, 1.001f);
  const Tensor x = Tensor::from(context, {100}, values);
  round_to_bf16(x.view(3, {37}));
  const std::vector<float> rounded = x.to_host();
  for (std::size_t i = 0; i < 100; ++i) CHECK(rounded[i] == (i >= 3 && i < 40 ? 1.0f : 1.001f));
}

}  // namespace bf16_test
