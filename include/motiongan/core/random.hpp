// Counter-based random numbers: Philox 4x32-10, bit-equal on host and device (cl/random.cl), and their keys.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>

#include "motiongan/core/tensor.hpp"

namespace motiongan {

/// Four random words, or a counter of 128 bits.
using PhiloxWords = std::array<std::uint32_t, 4>;

/// Philox 4x32-10 (Salmon et al. 2011): four random words for a 128-bit counter and a 64-bit key.
inline PhiloxWords philox(PhiloxWords counter, std::uint64_t seed) {
  auto key0 = static_cast<std::uint32_t>(seed), key1 = static_cast<std::uint32_t>(seed >> 32);
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t product0 = std::uint64_t{0xD2511F53u} * counter[0],
                        product1 = std::uint64_t{0xCD9E8D57u} * counter[2];
    counter = {
        static_cast<std::uint32_t>(product1 >> 32) ^ counter[1] ^ key0, static_cast<std::uint32_t>(product1),
        static_cast<std::uint32_t>(product0 >> 32) ^ counter[3] ^ key1, static_cast<std::uint32_t>(product0)};
    key0 += 0x9E3779B9u;
    key1 += 0xBB67AE85u;
  }
  return counter;
}

/// The purpose of a random number. A number depends only on seed, stream, training step, sample and position.
/// The noise of level i of the generator is stream noise + i.
enum class RandomStream : std::uint32_t {
  weights = 1,
  windows = 2,
  captions = 3,
  cut = 4,
  shift = 5,
  interpolation = 6,
  seeding = 7,
  rollout = 8,
  noise = 32
};

/// The stream `level` places further, such as that of a level of noise.
inline RandomStream operator+(RandomStream stream, std::size_t level) {
  return static_cast<RandomStream>(static_cast<std::uint32_t>(stream) + static_cast<std::uint32_t>(level));
}

/// Identifies an array of random numbers: seed, stream and step, and where its samples and frames begin.
struct RandomKey {
  std::uint64_t seed = 0;                     ///< the user's
  RandomStream stream = RandomStream::noise;  ///< the purpose
  std::uint32_t step = 0;          ///< at most 2^24 - 1; the stream fills the low 8 bits of the same word
  std::uint32_t first_sample = 0;  ///< of the array
  std::int32_t first_frame = 0;    ///< of the array

  /// The same key for another purpose.
  RandomKey with(RandomStream other) const {
    RandomKey key = *this;
    key.stream = other;
    return key;
  }
  /// The halves of the seed, as kernels take them.
  /// \{
  cl_uint seed_low() const { return static_cast<cl_uint>(seed); }
  cl_uint seed_high() const { return static_cast<cl_uint>(seed >> 32); }
  /// \}
};

/// One random word, on the host; `sample` and `position` as on the device.
inline std::uint32_t random_word(const RandomKey& key, std::uint32_t sample, std::uint32_t position = 0) {
  return philox(
      {position, 0, key.first_sample + sample, static_cast<std::uint32_t>(key.stream) ^ (key.step << 8)},
      key.seed)[0];
}
/// Uniform in 0 .. count - 1.
inline std::size_t random_below(const RandomKey& key, std::uint32_t sample, std::size_t count,
                                std::uint32_t position = 0) {
  return static_cast<std::size_t>((std::uint64_t{random_word(key, sample, position)} * count) >> 32);
}

/// Standard normal noise, [frames, batch, channels]. Row t of sample b belongs to frame key.first_frame + t
/// (+ frame_of[b] if given): a frame's noise does not depend on where the array begins. Throws Error unless
/// there is one frame_of per sample.
inline Tensor random_normal(const Context& context, const RandomKey& key, std::size_t frames,
                            std::size_t batch, std::size_t channels, const Indices& frame_of = {}) {
  require(frame_of.empty() || frame_of.size() == batch, "random_normal: ", frame_of.size(),
          " first frames for ", batch, " samples");
  Tensor out(context, {frames, batch, channels});
  context.launch("random", "random_normal", LaunchGrid::items(frames * batch * ((channels + 63) / 64)), out,
                 frames, batch, channels, key.seed_low(), key.seed_high(), static_cast<cl_uint>(key.stream),
                 key.step, key.first_sample, key.first_frame,
                 frame_of.empty() ? static_cast<cl_mem>(nullptr) : frame_of.buffer());
  return out;
}

/// Fills `out` [frames, batch, channels] with the noise of random_normal() for step 0, with one key per
/// sample: `keys` [batch, 4] holds (low word of the seed, high word, sample, frame), and row t of sample b
/// belongs to frame keys[b][3] + first_frame + t. Throws Error if `keys` is too short.
inline void fill_normal_each(const Tensor& out, RandomStream stream, std::int32_t first_frame,
                             const Indices& keys) {
  const std::size_t frames = out.dim(0), batch = out.dim(1), channels = out.dim(2);
  require(keys.size() >= 4 * batch, "fill_normal_each: keys has ", keys.size(),
          " elements, expected 4 for each of ", batch, " samples");
  out.context().launch("random", "random_normal_each",
                       LaunchGrid::items(frames * batch * ((channels + 63) / 64)), out, frames, batch,
                       channels, static_cast<cl_uint>(stream), first_frame, keys);
}

/// Uniform in (0, 1), one number per sample: [batch].
inline Tensor random_uniform(const Context& context, const RandomKey& key, std::size_t batch) {
  Tensor out(context, {batch});
  context.launch("random", "random_uniform", LaunchGrid::items(batch), out, batch, key.seed_low(),
                 key.seed_high(), static_cast<cl_uint>(key.stream), key.step, key.first_sample);
  return out;
}

/// Uniform integers in [low, low + count), one per sample: [batch]. Throws Error if there is none or one does
/// not fit an int.
inline Indices random_integers(const Context& context, const RandomKey& key, std::size_t batch, int low,
                               std::size_t count) {
  constexpr auto most = std::numeric_limits<cl_int>::max();
  require(count > 0 && count <= static_cast<std::size_t>(most) + 1 &&
              low <= most - static_cast<long long>(count - 1),
          "random_integers: ", count, " integers from ", low, ", expected at least one and none above ",
          most);
  Indices out(context, batch);
  out.set_range(low, static_cast<cl_int>(low + static_cast<long long>(count - 1)));
  context.launch("random", "random_integers", LaunchGrid::items(batch), out, batch, static_cast<cl_int>(low),
                 count, key.seed_low(), key.seed_high(), static_cast<cl_uint>(key.stream), key.step,
                 key.first_sample);
  return out;
}

}  // namespace motiongan
