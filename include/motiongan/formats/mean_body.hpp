// A body of mean proportions with the joints of the SMPL body models, for files that hold rotations only.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// The 22 body joints of SMPL, SMPL-H and SMPL-X, in the order of their pose parameters.
inline constexpr std::array<std::string_view, 22> smpl_body_joints{
    "pelvis",     "left_hip",    "right_hip",    "spine1",     "left_knee",     "right_knee",
    "spine2",     "left_ankle",  "right_ankle",  "spine3",     "left_foot",     "right_foot",
    "neck",       "left_collar", "right_collar", "head",       "left_shoulder", "right_shoulder",
    "left_elbow", "right_elbow", "left_wrist",   "right_wrist"};

/// The 15 joints of a hand without the side, in the order of SMPL-H's pose parameters (left hand first).
inline constexpr std::array<std::string_view, 15> smpl_hand_joints{
    "index1", "index2", "index3", "middle1", "middle2", "middle3", "pinky1", "pinky2",
    "pinky3", "ring1",  "ring2",  "ring3",   "thumb1",  "thumb2",  "thumb3"};

namespace mean_body_detail {

constexpr double stature = 1.70;  // metres

// Fractions of stature (Drillis & Contini 1966; Winter, Biomechanics and Motor Control of Human Movement).
constexpr double ankle_height = 0.039, knee_height = 0.285, hip_height = 0.530, shoulder_height = 0.818;
constexpr double chin_height = 0.870, shoulder_to_middle = 0.129, hip_breadth = 0.191, upper_arm = 0.186;
constexpr double forearm = 0.146, hand = 0.108, foot = 0.152;

// What these sources do not give: the hip joints lie half the hip breadth apart, the pelvis a little above
// them, the ball of the foot at 70% and the ankle at 25% of the foot's length from the heel.
constexpr double hip_to_middle = hip_breadth / 4, pelvis_height = 0.550, collar_to_middle = 0.030;
constexpr double ball_height = 0.012, ankle_to_ball = 0.45 * foot, ball_to_toe = 0.30 * foot;

/// Builds the skeleton depth first. Offsets are in fractions of stature; those of the left side are mirrored
/// for the right.
class Builder {
 public:
  explicit Builder(bool hands) : hands_(hands) {
    constexpr double spine = (shoulder_height - pelvis_height) / 4;
    joint("pelvis", "", {});
    for (const char* side : {"left_", "right_"}) {
      side_ = side;
      joint("hip", "pelvis", {hip_to_middle, hip_height - pelvis_height, 0});
      joint("knee", side_ + "hip", {0, knee_height - hip_height, 0});
      joint("ankle", side_ + "knee", {0, ankle_height - knee_height, 0});
      joint("foot", side_ + "ankle", {0, ball_height - ankle_height, ankle_to_ball});
      end({0, 0, ball_to_toe});
    }
    side_.clear();
    joint("spine1", "pelvis", {0, spine, 0});
    joint("spine2", "spine1", {0, spine, 0});
    joint("spine3", "spine2", {0, spine, 0});
    joint("neck", "spine3", {0, spine, 0});
    joint("head", "neck", {0, chin_height - shoulder_height, 0});
    end({0, 1 - chin_height, 0});
    for (const char* side : {"left_", "right_"}) {
      side_ = side;
      joint("collar", "spine3", {collar_to_middle, spine, 0});
      joint("shoulder", side_ + "collar", {shoulder_to_middle - collar_to_middle, 0, 0});
      joint("elbow", side_ + "shoulder", {upper_arm, 0, 0});
      joint("wrist", side_ + "elbow", {forearm, 0, 0});
      if (hands_)
        fingers();
      else
        end({hand, 0, 0});
    }
    skeleton_.joints.front().channels.insert(skeleton_.joints.front().channels.begin(),
                                             {Channel::x_position, Channel::y_position, Channel::z_position});
  }

  Skeleton take() { return std::move(skeleton_); }

 private:
  void joint(std::string_view name, const std::string& parent, const Vec3& offset) {
    Joint out;
    out.name = side_ + std::string(name);
    out.parent = skeleton_.find(parent);
    out.offset = metres(offset);
    out.channels = {Channel::z_rotation, Channel::x_rotation, Channel::y_rotation};
    skeleton_.joints.push_back(std::move(out));
  }
  void end(const Vec3& offset) { skeleton_.joints.back().end_site = metres(offset); }
  Vec3 metres(const Vec3& offset) const {
    const double side = side_ == "right_" ? -1 : 1;
    return {side * stature * offset[0], stature * offset[1], stature * offset[2]};
  }

  /// Palm down and thumb to the front. Knuckles at 45% of the hand's length; a finger's three bones are 50,
  /// 30 and 20% of the rest of it.
  void fingers() {
    struct Finger {
      const char* name;
      double length;  // of wrist to finger tip, in hands
      double front;   // of the knuckle, in fractions of stature
    };
    for (const auto& [name, reach, front] : {Finger{"index", 0.93, 0.018}, Finger{"middle", 1, 0.006},
                                             Finger{"pinky", 0.80, -0.018}, Finger{"ring", 0.93, -0.006}}) {
      const double knuckle = 0.45 * hand, rest = (reach - 0.45) * hand;
      chain(name, {knuckle, 0, front}, {1, 0, 0}, {0.5 * rest, 0.3 * rest, 0.2 * rest});
    }
    const double diagonal = std::sqrt(0.5);
    chain("thumb", {0.15 * hand, 0, 0.010}, {diagonal, 0, diagonal}, {0.25 * hand, 0.18 * hand, 0.14 * hand});
  }
  void chain(const std::string& name, const Vec3& start, const Vec3& direction, const Vec3& bones) {
    joint(name + "1", side_ + "wrist", start);
    joint(name + "2", side_ + name + "1", scale(direction, bones[0]));
    joint(name + "3", side_ + name + "2", scale(direction, bones[1]));
    end(scale(direction, bones[2]));
  }

  bool hands_;
  std::string side_;  ///< prepended to names
  Skeleton skeleton_;
};

}  // namespace mean_body_detail

/// The 22 body joints of SMPL, with `hands` also SMPL-H's 30 joints of the hands, by name and depth first,
/// with the bones of a mean body 1.70 m tall (Drillis & Contini 1966): metres, y up, in T-pose, facing +z,
/// left at +x. The pelvis has position channels, and all joints rotation channels Z, X, Y. These are not the
/// bones of a body model or of any subject.
inline Skeleton mean_body_skeleton(bool hands) { return mean_body_detail::Builder(hands).take(); }

}  // namespace motiongan::motion
