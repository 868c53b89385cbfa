// Reproducible random numbers and smooth curves over time, for procedural motion.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include "motiongan/motion/rotation.hpp"

namespace motiongan::motion::procedural {

/// Random numbers that are identical with every compiler and library (std distributions are not): splitmix64
/// seeded by a hash of (seed, stream).
class Dice {
 public:
  Dice(std::uint64_t seed, std::uint64_t stream) : state_(mix(mix(seed) + golden * (stream + 1))) {}

  std::uint64_t next() { return mix(state_ += golden); }
  /// Uniform in [low, high).
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(next() >> 11) * 0x1p-53;
  }
  bool chance(double probability) { return uniform(0, 1) < probability; }
  /// Uniform in 0 .. count - 1.
  std::size_t pick(std::size_t count) { return static_cast<std::size_t>(next() % count); }

 private:
  static constexpr std::uint64_t golden = 0x9E3779B97F4A7C15ULL;
  static std::uint64_t mix(std::uint64_t v) {
    v = (v ^ (v >> 30)) * 0xBF58476D1CE4E5B9ULL;
    v = (v ^ (v >> 27)) * 0x94D049BB133111EBULL;
    return v ^ (v >> 31);
  }
  std::uint64_t state_;
};

/// 0 below 0, 1 above 1, with zero slope at both ends.
inline double ease(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

/// A bump over [0, 1]: 0 with zero slope at both ends, 1 in the middle.
inline double hump(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return 16 * u * u * (1 - u) * (1 - u);
}

inline double wave(double turns) { return std::sin(2 * pi * turns); }
inline double cowave(double turns) { return std::cos(2 * pi * turns); }
inline double fraction(double u) { return u - std::floor(u); }

/// Smooth minimum of a and b: below both, by at most softness * ln 2 where they meet.
inline double soft_min(double a, double b, double softness) {
  return std::min(a, b) - softness * std::log1p(std::exp(-std::abs(a - b) / softness));
}

struct Key {
  double at = 0, value = 0;
  double slope = 0;
};

/// Cubic Hermite curve through keys, constant outside them; C1 if the outer slopes are zero.
class Curve {
 public:
  Curve(std::initializer_list<Key> keys) : keys_(keys) {}

  double operator()(double at) const {
    if (at <= keys_.front().at) return keys_.front().value;
    if (at >= keys_.back().at) return keys_.back().value;
    std::size_t i = 0;
    while (keys_[i + 1].at < at) ++i;
    const Key &a = keys_[i], &b = keys_[i + 1];
    const double h = b.at - a.at, u = (at - a.at) / h, s = ease(u);
    return a.value + (b.value - a.value) * s + h * u * (1 - u) * (a.slope * (1 - u) - b.slope * u);
  }

 private:
  std::vector<Key> keys_;
};

/// A repetition of a gesture: which one, and how far it has progressed.
struct Beat {
  double phase = 0;     ///< in [0, 1)
  double strength = 1;  ///< varies slightly between repetitions
  std::int64_t count = 0;
};

/// The repetition at time t (seconds) of a gesture with the given period (seconds). `seed` determines the
/// strengths; a gesture scaled by them must be at rest at phase 0, or it jumps.
inline Beat beat_at(double t, double period, double start, std::uint64_t seed) {
  const double cycles = t / period + start;
  Beat beat;
  beat.count = static_cast<std::int64_t>(std::floor(cycles));
  beat.phase = cycles - std::floor(cycles);
  beat.strength = Dice(seed, static_cast<std::uint64_t>(beat.count + 1000)).uniform(0.88, 1.12);
  return beat;
}

}  // namespace motiongan::motion::procedural
