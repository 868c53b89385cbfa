// Low-pass filters over time that do not delay: of numbers, and of the rotations of a motion.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/kinematics.hpp"

namespace motiongan::motion {

/// The weights of frames -n .. n of a Gaussian low-pass whose gain is one half (-3 dB in power) at `cutoff`
/// Hz, for `rate` frames per second; they sum to 1.
inline std::vector<double> gaussian_kernel(double cutoff, double rate) {
  require(cutoff > 0 && rate > 0, "a low-pass of ", cutoff, " Hz at ", rate,
          " frames per second, expected numbers above 0");
  const double sigma = std::sqrt(std::log(2.0)) / (2 * pi * cutoff) * rate;  // in frames
  const auto reach = static_cast<std::size_t>(std::ceil(3 * sigma));
  std::vector<double> kernel(2 * reach + 1);
  double sum = 0;
  for (std::size_t i = 0; i < kernel.size(); ++i) {
    const double x = (static_cast<double>(i) - static_cast<double>(reach)) / std::max(sigma, 1e-9);
    sum += kernel[i] = std::exp(-x * x / 2);
  }
  for (double& weight : kernel) weight /= sum;
  return kernel;
}

/// The weighted sum of the frames around `at`; the motion's ends are continued by their mirror images through
/// the end point, so that a steady motion stays what it is. `value(i)` is frame i of `frames`.
template <class Value>
double filtered(const std::vector<double>& kernel, std::size_t frames, std::size_t at, const Value& value) {
  const auto reach = static_cast<std::ptrdiff_t>(kernel.size() / 2),
             last = static_cast<std::ptrdiff_t>(frames) - 1;
  const auto inside = [&](std::ptrdiff_t i) {
    return value(static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(i, 0, last)));
  };
  double sum = 0;
  for (std::ptrdiff_t k = -reach; k <= reach; ++k) {
    const std::ptrdiff_t i = static_cast<std::ptrdiff_t>(at) + k;
    const double v = i < 0      ? 2 * inside(0) - inside(-i)
                     : i > last ? 2 * inside(last) - inside(2 * last - i)
                                : inside(i);
    sum += kernel[static_cast<std::size_t>(k + reach)] * v;
  }
  return sum;
}

/// The motion without what is faster than `cutoff` Hz, in the rotations of all joints and the positions of
/// those that move. Zero phase: nothing is delayed. Throws Error unless cutoff is above 0.
inline Motion low_pass(const Motion& motion, double cutoff) {
  check_motion(motion);
  const std::vector<double> kernel = gaussian_kernel(cutoff, motion.rate);
  Motion out = motion;
  if (motion.frames < 2) return out;
  const std::size_t joints = motion.skeleton.size();
  std::vector<Quat> turns(motion.frames);
  for (std::size_t j = 0; j < joints; ++j) {
    for (std::size_t f = 0; f < motion.frames;
         ++f) {  // q and -q are one rotation: each on the side of the last
      Quat q = motion.rotation(f, j);
      if (f > 0 && dot(q, turns[f - 1]) < 0) q = {-q.w, -q.x, -q.y, -q.z};
      turns[f] = q;
    }
    for (std::size_t f = 0; f < motion.frames; ++f) {
      const auto part = [&](double Quat::*member) {
        return filtered(kernel, motion.frames, f, [&](std::size_t i) { return turns[i].*member; });
      };
      out.rotation(f, j) = normalize({part(&Quat::w), part(&Quat::x), part(&Quat::y), part(&Quat::z)});
      for (std::size_t a = 0; a < 3; ++a)
        out.position(f, j)[a] =
            filtered(kernel, motion.frames, f, [&](std::size_t i) { return motion.position(i, j)[a]; });
    }
  }
  return out;
}

}  // namespace motiongan::motion
