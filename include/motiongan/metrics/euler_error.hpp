// The Euler-angle error of the motion-prediction papers (Martinez et al. 2017; see docs/evaluation.md).
#pragma once
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/rotation.hpp"

namespace motiongan {

/// Euler angles, in radians, of a rotation matrix in the motion-prediction papers' convention, including
/// their branch at |R02| = 1: another convention gives different errors.
inline motion::Vec3 prediction_euler(const motion::Mat3& r) {
  if (r[2] >= 1 || r[2] <= -1) {
    const double delta = std::atan2(r[1], r[2]);
    return {delta, r[2] < 0 ? motion::pi / 2 : -motion::pi / 2, 0};
  }
  const double second = -std::asin(r[2]), c = std::cos(second);
  return {std::atan2(r[5] / c, r[8] / c), second, std::atan2(r[1] / c, r[0] / c)};
}

/// The same for an exponential map, in radians, with the papers' epsilon in the normalisation of the axis.
inline motion::Vec3 prediction_euler(const motion::Vec3& expmap) {
  constexpr double eps = 1.1920928955078125e-7;  // single-precision epsilon; avoids a division by zero
  const double angle = motion::length(expmap);
  const motion::Vec3 axis = motion::scale(expmap, 1 / (angle + eps));
  const motion::Mat3 k{0, -axis[2], axis[1], axis[2], 0, -axis[0], -axis[1], axis[0], 0};
  const motion::Mat3 k2 = motion::multiply(k, k);
  motion::Mat3 r{1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (std::size_t i = 0; i < 9; ++i) r[i] += std::sin(angle) * k[i] + (1 - std::cos(angle)) * k2[i];
  return prediction_euler(r);
}

/// Error of each frame, [frames], in radians: the Euclidean distance between Euler angles, without wrapping,
/// over the angles whose standard deviation in the ground truth is above 1e-4. `truth` and `prediction` are
/// exponential maps [frames, 3 * joints], without the root's. Throws Error if the sizes do not fit.
inline std::vector<double> euler_errors(std::span<const double> truth, std::span<const double> prediction,
                                        std::size_t frames) {
  require(truth.size() == prediction.size(), "found ", truth.size(), " values of the ground truth and ",
          prediction.size(), " of the prediction, expected the same number");
  require(frames > 0 && truth.size() % (3 * frames) == 0, "found ", truth.size(), " values in ", frames,
          " frames, expected 3 for every joint and frame, and at least one frame");
  const std::size_t width = truth.size() / frames;
  const auto euler = [](std::span<const double> expmaps) {
    std::vector<double> out;
    out.reserve(expmaps.size());
    for (std::size_t i = 0; i < expmaps.size(); i += 3)
      for (const double angle : prediction_euler(motion::Vec3{expmaps[i], expmaps[i + 1], expmaps[i + 2]}))
        out.push_back(angle);
    return out;
  };
  const std::vector<double> a = euler(truth), b = euler(prediction);
  std::vector<double> errors(frames);
  for (std::size_t d = 0; d < width; ++d) {
    double mean = 0, squares = 0;
    for (std::size_t f = 0; f < frames; ++f) mean += a[f * width + d] / static_cast<double>(frames);
    for (std::size_t f = 0; f < frames; ++f) squares += (a[f * width + d] - mean) * (a[f * width + d] - mean);
    if (!(std::sqrt(squares / static_cast<double>(frames)) > 1e-4)) continue;
    for (std::size_t f = 0; f < frames; ++f) {
      const double difference = a[f * width + d] - b[f * width + d];
      errors[f] += difference * difference;
    }
  }
  for (double& e : errors) e = std::sqrt(e);
  return errors;
}

/// The same for motions of one skeleton, rate and length, [frames]: local rotations of all joints but `root`,
/// whose position and rotation the papers leave out. The papers' text files hold exponential maps of the
/// inverse rotations; rotations are inverted here too, so that a BVH file gives the same errors as its text
/// file. Throws Error if skeletons, rates or lengths differ.
inline std::vector<double> euler_errors(const motion::Motion& truth, const motion::Motion& prediction,
                                        std::size_t root = 0) {
  const motion::Motion* const both[] = {&truth, &prediction};
  require(truth.frames == prediction.frames && truth.skeleton.size() == prediction.skeleton.size(),
          "the ground truth has ", truth.frames, " frames of ", truth.skeleton.size(),
          " joints, the "
          "prediction ",
          prediction.frames, " of ", prediction.skeleton.size(), ", expected the same");
  require(std::abs(truth.rate - prediction.rate) <= 1e-6 * truth.rate, "the ground truth has ", truth.rate,
          " frames per second, the prediction ", prediction.rate, "; resample() one of them");
  require(root < truth.skeleton.size(), "root joint ", root, " is not one of the skeleton's ",
          truth.skeleton.size(), " joints");
  std::vector<double> expmaps[2];
  for (std::size_t m = 0; m < 2; ++m) {
    motion::check_motion(*both[m]);
    for (std::size_t f = 0; f < truth.frames; ++f)
      for (std::size_t j = 0; j < truth.skeleton.size(); ++j) {
        if (j == root) continue;
        const motion::Vec3 r = motion::expmap_from_quat(motion::inverse(both[m]->rotation(f, j)));
        expmaps[m].insert(expmaps[m].end(), r.begin(), r.end());
      }
  }
  return euler_errors(expmaps[0], expmaps[1], truth.frames);
}

}  // namespace motiongan
