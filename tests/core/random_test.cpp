// Philox: known answers, device against host, and what a random number depends on.
#include <doctest/doctest.h>

#include <motiongan/core/random.hpp>
#include <numbers>

namespace random_test {

using namespace motiongan;

namespace {

const Context& floats() {
  static const Context context;
  return context;
}

std::vector<float> normals(const RandomKey& key, std::size_t frames, std::size_t batch,
                           std::size_t channels) {
  return random_normal(floats(), key, frames, batch, channels).to_host();
}

/// Uniform in (0, 1) from a word, as on the device.
double unit(std::uint32_t word) { return ((word >> 9) + 0.5) * 0x1p-23; }

/// One value of random_normal, from the definition in the kernel's comment.
double host_normal(const RandomKey& key, std::uint32_t frame, std::uint32_t sample, std::uint32_t channel) {
  const std::uint32_t block = channel / 64, quarter = channel % 64 / 16, lane = channel % 16;
  const PhiloxWords w = philox({block * 16 + lane, key.first_frame + frame, key.first_sample + sample,
                                static_cast<std::uint32_t>(key.stream) ^ (key.step << 8)},
                               key.seed);
  const double radius = std::sqrt(-2 * std::log(unit(w[quarter < 2 ? 0 : 2]))),
               angle = 2 * std::numbers::pi * unit(w[quarter < 2 ? 1 : 3]);
  return radius * (quarter % 2 == 0 ? std::cos(angle) : std::sin(angle));
}

}  // namespace

TEST_CASE("known answers of Philox 4x32-10 (Salmon et al., their test vectors)") {
  CHECK(philox({0, 0, 0, 0}, 0) == PhiloxWords{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
  const std::uint32_t ones = 0xffffffff;
  CHECK(philox({ones, ones, ones, ones}, ~std::uint64_t{0}) ==
        PhiloxWords{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
  CHECK(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, 0x299f31d0a4093822u) ==
        PhiloxWords{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1});
}

TEST_CASE("uniform values and integers of the device equal the host's") {
  const RandomKey key{
      .seed = 0x0123456789abcdefu, .stream = RandomStream::interpolation, .step = 70'001, .first_sample = 5};
  const std::size_t n = 1000;
  const std::vector<float> uniform = random_uniform(floats(), key, n).to_host();
  const std::vector<cl_int> whole = random_integers(floats(), key, n, -16, 33).to_host();
  for (std::uint32_t i = 0; i < n; ++i) {
    REQUIRE(uniform[i] == static_cast<float>(unit(random_word(key, i))));
    REQUIRE(whole[i] == -16 + static_cast<int>(random_below(key, i, 33)));
  }
  CHECK(*std::min_element(uniform.begin(), uniform.end()) > 0);
  CHECK(*std::max_element(uniform.begin(), uniform.end()) < 1);
  CHECK(*std::min_element(whole.begin(), whole.end()) == -16);
  CHECK(*std::max_element(whole.begin(), whole.end()) == 16);
}

TEST_CASE("integers are uniformly distributed") {
  std::vector<int> counts(10);
  const std::size_t n = 100'000;
  for (cl_int v : random_integers(floats(), {.seed = 3, .stream = RandomStream::cut}, n, 0, 10).to_host())
    ++counts.at(static_cast<std::size_t>(v));
  for (int count : counts) CHECK(std::abs(count - 10'000) < 475);  // 5 standard deviations
}

TEST_CASE("normal values follow the definition, in float and double" * doctest::test_suite("double")) {
  const RandomKey key{
      .seed = 99, .stream = RandomStream::noise + 3, .step = 12, .first_sample = 40, .first_frame = 7};
  const Context doubles({.precision = Precision::f64});
  for (std::size_t channels : {1, 5, 15, 16, 17, 63, 64, 65, 93, 130}) {
    const std::size_t frames = 3, batch = 2;
    const std::vector<float> ours = normals(key, frames, batch, channels);
    const std::vector<double> in_double =
        random_normal(doubles, key, frames, batch, channels).to_host<double>();
    double worst = 0, worst_double = 0;
    for (std::size_t i = 0; i < ours.size(); ++i) {
      const double expected = host_normal(key, static_cast<std::uint32_t>(i / channels / batch),
                                          static_cast<std::uint32_t>(i / channels % batch),
                                          static_cast<std::uint32_t>(i % channels));
      worst = std::max(worst, std::abs(ours[i] - expected));
      worst_double = std::max(worst_double, std::abs(in_double[i] - ours[i]));
    }
    CAPTURE(channels);
    CHECK(worst < 1e-5);
    CHECK(worst_double < 1e-6);
  }
}

TEST_CASE("moments of the normal values") {
  const std::vector<float> x = normals({.seed = 2024}, 10, 100, 1000);
  const double n = static_cast<double>(x.size());
  double mean = 0, square = 0, cube = 0, fourth = 0;
  for (double v : x) {
    mean += v / n;
    square += v * v / n;
    cube += v * v * v / n;
    fourth += v * v * v * v / n;
  }
  // Five standard deviations of each moment's estimate from 10^6 values.
  CHECK(std::abs(mean) < 5 * std::sqrt(1 / n));
  CHECK(std::abs(square - 1) < 5 * std::sqrt(2 / n));
  CHECK(std::abs(cube) < 5 * std::sqrt(15 / n));
  CHECK(std::abs(fourth - 3) < 5 * std::sqrt(96 / n));
}

TEST_CASE("a sample is the same in any batch, a frame the same in any length") {
  const RandomKey key{.seed = 7, .stream = RandomStream::noise + 1, .step = 3};
  for (std::size_t channels : {1, 8, 16, 17, 64, 93, 256}) {
    const std::size_t frames = 4, batch = 9;
    const std::vector<float> all = normals(key, frames, batch, channels);
    for (std::uint32_t sample : {0u, 4u, 8u}) {
      RandomKey alone = key;
      alone.first_sample = sample;
      const std::vector<float> one = normals(alone, frames, 1, channels);
      for (std::size_t t = 0; t < frames; ++t)
        for (std::size_t c = 0; c < channels; ++c)
          REQUIRE(one[t * channels + c] == all[(t * batch + sample) * channels + c]);
    }
    RandomKey later = key;
    later.first_frame = 3;
    const std::vector<float> last = normals(later, 1, batch, channels);
    for (std::size_t i = 0; i < last.size(); ++i) REQUIRE(last[i] == all[3 * batch * channels + i]);
  }
  // Each sample from its own first frame, as for the final cut; also before frame 0.
  const std::vector<cl_int> from{0, 2, 1};
  RandomKey earlier = key;
  earlier.first_frame = -1;
  const std::vector<float> cut =
                               random_normal(floats(), earlier, 3, 3, 20, Indices(floats(), from)).to_host(),
                           whole = normals(key, 6, 3, 20);
  for (std::size_t t = 0; t < 3; ++t)
    for (std::size_t b = 0; b < 3; ++b)
      for (std::size_t c = 0; c < 20; ++c) {
        const long frame = static_cast<long>(t) - 1 + from[b];
        if (frame >= 0)
          REQUIRE(cut[(t * 3 + b) * 20 + c] == whole[(static_cast<std::size_t>(frame) * 3 + b) * 20 + c]);
      }
  const std::vector<float> uniform = random_uniform(floats(), key, 9).to_host();
  RandomKey fifth = key;
  fifth.first_sample = 4;
  CHECK(random_uniform(floats(), fifth, 1).to_host()[0] == uniform[4]);
}

TEST_CASE("another seed, stream, step, sample or frame gives other values, an equal key equal ones") {
  const RandomKey key{.seed = 1, .stream = RandomStream::noise, .step = 1};
  const std::vector<float> reference = normals(key, 2, 2, 20);
  CHECK(normals(key, 2, 2, 20) == reference);
  std::vector<RandomKey> others(7, key);
  others[0].seed = 2;
  others[1].seed = key.seed + (std::uint64_t{1} << 32);
  others[2].stream = RandomStream::noise + 1;
  others[3].step = 2;
  others[4].first_sample = 2;
  others[5].first_frame = 2;
  others[6].step = 1 << 16;
  std::vector<std::vector<float>> drawn{reference};
  for (const RandomKey& other : others) {
    const std::vector<float> here = normals(other, 2, 2, 20);
    for (const auto& before : drawn) {
      std::size_t equal = 0;
      for (std::size_t i = 0; i < here.size(); ++i) equal += here[i] == before[i];
      CHECK(equal == 0);
    }
    drawn.push_back(here);
  }
}

TEST_CASE("per-sample keys give the values of random_normal") {
  const Context context;
  const std::uint64_t seeds[] = {7, 0x123456789abcdefull, 7};
  const std::uint32_t samples[] = {0, 4000000000u, 5};
  const std::int32_t frames[] = {0, 3, -2};
  std::vector<cl_int> keys;
  for (int b = 0; b < 3; ++b)
    for (const std::uint32_t word :
         {static_cast<std::uint32_t>(seeds[b]), static_cast<std::uint32_t>(seeds[b] >> 32), samples[b],
          static_cast<std::uint32_t>(frames[b])})
      keys.push_back(static_cast<cl_int>(word));
  const Tensor all(context, {2, 3, 70});
  fill_normal_each(all, RandomStream::noise, 10, Indices(context, keys));
  const std::vector<float> values = all.to_host();
  for (std::size_t b = 0; b < 3; ++b) {
    const RandomKey key{.seed = seeds[b], .first_sample = samples[b], .first_frame = 10 + frames[b]};
    const std::vector<float> alone = random_normal(context, key, 2, 1, 70).to_host();
    for (std::size_t t = 0; t < 2; ++t)
      for (std::size_t c = 0; c < 70; ++c) CHECK(values[(t * 3 + b) * 70 + c] == alone[t * 70 + c]);
  }
  CHECK_THROWS_AS(fill_normal_each(all, RandomStream::noise, 0, Indices(context, 11)), Error);
}

}  // namespace random_test
