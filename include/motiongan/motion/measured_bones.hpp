// Bones that a file holds in position channels instead of in its OFFSETs.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/motion/root_joint.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// A bone whose length varies over a clip.
struct StretchingBone {
  std::size_t joint = 0;  ///< at the bone's end
  double stretch = 0;     ///< largest deviation from the median length, as a fraction of it
};

/// What measure_bones found.
struct MeasuredBones {
  std::vector<std::size_t> displaced;  ///< joints whose channels were displacements from their offsets
  std::vector<std::size_t> measured;   ///< joints whose offsets were replaced
  double median = 0;                   ///< median length of those bones, in the file's unit
  double spread = 0;                   ///< largest deviation of any of them from its median, as a fraction
  std::vector<StretchingBone> stretching;  ///< bones that stretch by more than 5 %
};

namespace measured_bones_detail {

inline double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

inline bool has_positions(const Joint& joint) {
  return std::any_of(joint.channels.begin(), joint.channels.end(), [](Channel c) { return !is_rotation(c); });
}

/// Makes positions of the channels of joint j, which are displacements from its offset.
inline void add_offset(Motion& motion, std::size_t j) {
  const Joint& joint = motion.skeleton.joints[j];
  for (std::size_t f = 0; f < motion.frames; ++f)
    for (const Channel c : joint.channels)
      if (!is_rotation(c)) motion.position(f, j)[axis(c)] += joint.offset[axis(c)];
}

}  // namespace measured_bones_detail

/// Measures the bones of joints that have position channels, except those that carry the body (body_chain).
/// Where the offset differs from the median position by more than a thousandth of the bone (files with zero
/// OFFSETs), the median becomes the offset, so that motion without these channels keeps its shape. Where the
/// positions are near zero although the offset is not, they are displacements from it (as MakeHuman writes
/// them), not positions: the offset is added.
inline MeasuredBones measure_bones(Motion& motion) {
  namespace detail = measured_bones_detail;
  MeasuredBones out;
  if (motion.frames == 0) return out;
  const std::size_t hop = 1 + motion.frames / 1000;
  const std::vector<Joint>& joints = motion.skeleton.joints;
  if (std::none_of(joints.begin() + 1, joints.end(), detail::has_positions)) return out;
  std::vector<std::size_t> carriers = body_chain(motion);
  // In a plain chain, only the joints down to the one that travels carry the rest.
  const auto root = static_cast<std::size_t>(moving_root(motion));
  const bool branches = std::count_if(joints.begin(), joints.end(), [&](const Joint& joint) {
                          return joint.parent == static_cast<int>(carriers.back());
                        }) > 1;
  if (!branches) std::erase_if(carriers, [&](std::size_t j) { return j > root; });
  std::vector<double> values, lengths, medians;
  for (std::size_t j = 1; j < joints.size(); ++j) {
    Joint& joint = motion.skeleton.joints[j];
    if (!detail::has_positions(joint) || std::find(carriers.begin(), carriers.end(), j) != carriers.end())
      continue;
    Vec3 middle{};
    for (std::size_t a = 0; a < 3; ++a) {
      values.clear();
      for (std::size_t f = 0; f < motion.frames; f += hop) values.push_back(motion.position(f, j)[a]);
      middle[a] = detail::median(values);
    }
    if (length(middle) < 0.1 * length(joint.offset)) {
      detail::add_offset(motion, j);
      out.displaced.push_back(j);
      continue;
    }
    lengths.clear();
    for (std::size_t f = 0; f < motion.frames; f += hop) lengths.push_back(length(motion.position(f, j)));
    const double usual = detail::median(lengths);
    double stretch = 0;
    for (const double l : lengths) stretch = std::max(stretch, std::abs(l - usual));
    stretch = usual > 0 ? stretch / usual : 0;
    if (stretch > 0.05) out.stretching.push_back({j, stretch});
    const double larger = std::max(length(middle), length(joint.offset));
    if (length(subtract(middle, joint.offset)) <= 1e-3 * larger) continue;
    joint.offset = middle;
    out.measured.push_back(j);
    out.spread = std::max(out.spread, stretch);
    medians.push_back(usual);
  }
  if (!medians.empty()) out.median = detail::median(medians);
  return out;
}

}  // namespace motiongan::motion
