// Finding and dropping the rest pose or T-pose that some conversions prepend to a clip.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "motiongan/core/fields.hpp"
#include "motiongan/motion/body_side.hpp"
#include "motiongan/motion/feet.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// What to do with a clip's first frame, which in the CMU conversions is an added T-pose.
enum class FirstFrame {
  automatic,  ///< drop the frames that t_pose_frames finds
  keep,
  drop  ///< always drop frame 0
};
constexpr NameTable<FirstFrame, 3> enum_names(FirstFrame) {
  return {{{FirstFrame::automatic, "auto"}, {FirstFrame::keep, "keep"}, {FirstFrame::drop, "drop"}}};
}

namespace first_frame_detail {

constexpr std::size_t most_posed = 4;

/// Mean rotation angle of all joints from the rest pose, in degrees.
inline double from_rest(const Motion& motion, std::size_t frame) {
  double sum = 0;
  for (std::size_t j = 0; j < motion.skeleton.size(); ++j)
    sum += degrees(angle_between(Quat{}, motion.rotation(frame, j)));
  return sum / static_cast<double>(motion.skeleton.size());
}

/// Mean change of all joints' rotations between two frames, in degrees.
inline double step_between(const Motion& motion, std::size_t a, std::size_t b) {
  double sum = 0;
  for (std::size_t j = 0; j < motion.skeleton.size(); ++j)
    sum += degrees(angle_between(motion.rotation(a, j), motion.rotation(b, j)));
  return sum / static_cast<double>(motion.skeleton.size());
}

/// Steps are compared with about this many of the motion's own.
constexpr std::size_t step_samples = 128;
/// The first sampled step if not all are: after the frames that may be posed.
constexpr std::size_t first_sample = most_posed + 1;

/// Frames from one sampled step to the next in a motion of `frames` frames.
constexpr std::size_t sample_hop(std::size_t frames) { return 1 + frames / step_samples; }

/// The step that 99 % of the steps from frame `first` on do not exceed, of every hop-th one.
inline double usual_step(const Motion& motion, std::size_t first, std::size_t hop) {
  std::vector<double> steps;
  if (hop > 1) first = first_sample;
  for (std::size_t f = first; f + 1 < motion.frames; f += hop)
    steps.push_back(step_between(motion, f, f + 1));
  if (steps.empty()) return 0;
  const auto at = steps.begin() + static_cast<std::ptrdiff_t>((steps.size() - 1) * 99 / 100);
  std::nth_element(steps.begin(), at, steps.end());
  return *at;
}

/// How far the chain from joint `from` down to `to` is stretched: the distance of its ends as a fraction of
/// its length.
inline double straightness(const Motion& motion, const std::vector<Vec3>& positions, std::size_t from,
                           std::size_t to) {
  double bones = 0;
  for (std::size_t j = to; j != from; j = static_cast<std::size_t>(motion.skeleton.joints[j].parent)) {
    if (motion.skeleton.joints[j].parent < 0) return 0;
    bones += length(motion.position(0, j));
  }
  return bones > 0 ? length(subtract(positions[to], positions[from])) / bones : 0;
}

/// The ends of an arm and a leg on one side: upper arm to hand, thigh to ankle.
struct Limbs {
  std::size_t arm = 0, hand = 0, thigh = 0, ankle = 0;
};

/// The limbs of a side (0: left, 1: right) by joint names; a limb is two bones. Nothing if one is not found.
inline std::optional<Limbs> find_limbs(const Skeleton& skeleton, std::size_t side,
                                       const std::vector<std::size_t>& feet) {
  const auto above = [&](int j, int count) {
    for (; j >= 0 && count > 0; --count) j = skeleton.joints[static_cast<std::size_t>(j)].parent;
    return j;
  };
  int hand = -1;
  for (std::size_t j = 0; j < skeleton.size() && hand < 0; ++j) {
    if (side_of(skeleton.joints[j].name) != (side == 0 ? Side::left : Side::right)) continue;
    const std::string name = feet_detail::lower_case(skeleton.joints[j].name);
    if (name.find("hand") != name.npos || name.find("wrist") != name.npos) hand = static_cast<int>(j);
  }
  const auto foot = static_cast<int>(feet[side]);
  const bool toe = feet_detail::lower_case(skeleton.joints[feet[side]].name).find("toe") != std::string::npos;
  const int ankle = toe ? above(foot, 1) : foot, arm = above(hand, 2), thigh = above(ankle, 2);
  if (arm < 0 || thigh < 0) return std::nullopt;
  return Limbs{static_cast<std::size_t>(arm), static_cast<std::size_t>(hand), static_cast<std::size_t>(thigh),
               static_cast<std::size_t>(ankle)};
}

/// Whether frame 0 is a T-pose or an A-pose whatever the rest pose is: both arms, from the upper arm to the
/// hand, are straight, mirrored, and raised by at least 20 degrees from hanging, and both legs are straight.
inline bool is_t_or_a_pose(const Motion& motion) {
  const Skeleton& skeleton = motion.skeleton;
  const std::vector<std::size_t> feet = feet_detail::feet_by_name(skeleton);
  if (feet.size() != 2) return false;
  const auto joints = static_cast<std::ptrdiff_t>(skeleton.size());
  const std::vector<Vec3> p =
      joint_positions({skeleton,
                       motion.rate,
                       1,
                       {motion.rotations.begin(), motion.rotations.begin() + joints},
                       {motion.positions.begin(), motion.positions.begin() + joints}});
  std::array<Vec3, 2> arms{}, thighs{};
  for (std::size_t side = 0; side < 2; ++side) {
    const std::optional<Limbs> limbs = find_limbs(skeleton, side, feet);
    if (!limbs || straightness(motion, p, limbs->arm, limbs->hand) < 0.98 ||
        straightness(motion, p, limbs->thigh, limbs->ankle) < 0.99)
      return false;
    const Vec3 leg = subtract(p[limbs->ankle], p[limbs->thigh]);
    arms[side] = subtract(p[limbs->hand], p[limbs->arm]);
    thighs[side] = p[limbs->thigh];
    const double hanging = dot(arms[side], leg) / (length(arms[side]) * length(leg));
    if (hanging > std::cos(radians(20))) return false;
  }
  // Arms mirrored: their sum lies in the body's plane of symmetry.
  const Vec3 across = subtract(thighs[0], thighs[1]);
  const double width = length(across);
  return width > 0 && std::abs(dot(add(arms[0], arms[1]), across)) < 0.1 * width * length(arms[0]);
}

}  // namespace first_frame_detail

/// Number of frames at the start that are a pose prepended to the motion, at most four: frames close to the
/// rest pose (joints turned by less than 15 degrees on average), or a first frame in a T-pose or A-pose,
/// followed by a jump far outside the clip's own steps. The jump is the mean over all joints; it must exceed
/// one degree, and the clip's 99th percentile by a factor of 3, or of 1.5 after a pose within 5 degrees of
/// rest. 0 if the clip starts with its motion. Steps are taken at every hop-th frame.
inline std::size_t t_pose_frames(const Motion& motion, std::size_t hop) {
  namespace detail = first_frame_detail;
  check_motion(motion);
  double rest[detail::most_posed]{};
  std::size_t posed = 0;
  while (posed < detail::most_posed && posed + 1 < motion.frames) {
    rest[posed] = detail::from_rest(motion, posed);
    if (rest[posed] >= 15) break;
    ++posed;
  }
  const bool t_pose = posed == 0 && motion.frames > 1 && detail::is_t_or_a_pose(motion);
  const auto jumps_after = [&](std::size_t count) {
    if (count + 1 >= motion.frames) return false;  // no step to compare with
    const double jump = detail::step_between(motion, count - 1, count);
    const double factor = !t_pose && rest[count - 1] < 5 ? 1.5 : 3;
    return jump > 1 && jump > factor * detail::usual_step(motion, count, hop);
  };
  const std::size_t last = t_pose ? 1 : posed;
  std::size_t count = 1;
  while (count <= last && !jumps_after(count)) ++count;
  if (count > last) return 0;
  // A second pose, or a blend of the pose and the motion as resampling makes it, jumps too.
  while (count < last && jumps_after(count + 1)) ++count;
  return count;
}

/// t_pose_frames() with steps at as many frames as a clip of this length needs.
inline std::size_t t_pose_frames(const Motion& motion) {
  return t_pose_frames(motion, first_frame_detail::sample_hop(motion.frames));
}

/// The frames of a clip that t_pose_frames reads, in order: the first ones, and pairs of consecutive frames.
/// Of a motion of these alone, t_pose_frames(motion, 2) is that of the whole. Empty if it reads all of them.
inline std::vector<std::size_t> sampled_frames(std::size_t frames) {
  namespace detail = first_frame_detail;
  const std::size_t hop = detail::sample_hop(frames);
  std::vector<std::size_t> out;
  if (hop < 3) return out;
  for (std::size_t f = 0; f < detail::first_sample; ++f) out.push_back(f);
  for (std::size_t f = detail::first_sample; f + 1 < frames; f += hop) out.insert(out.end(), {f, f + 1});
  return out;
}

/// Removes the first `count` frames; returns how many.
inline std::size_t drop_frames(Motion& motion, std::size_t count) {
  const auto values = static_cast<std::ptrdiff_t>(count * motion.skeleton.size());
  motion.rotations.erase(motion.rotations.begin(), motion.rotations.begin() + values);
  motion.positions.erase(motion.positions.begin(), motion.positions.begin() + values);
  motion.frames -= count;
  return count;
}

/// Removes the first frames according to `rule`; returns how many.
inline std::size_t drop_first_frames(Motion& motion, FirstFrame rule) {
  if (rule == FirstFrame::automatic) return drop_frames(motion, t_pose_frames(motion));
  return rule == FirstFrame::drop ? drop_frames(motion, std::min<std::size_t>(1, motion.frames)) : 0;
}

}  // namespace motiongan::motion
