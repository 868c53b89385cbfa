// Skeletons of data sets of joint positions whose files come without a bone list.
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/mean_body.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

inline constexpr double humanml3d_rate = 20;  ///< frames per second of HumanML3D's joint positions
inline constexpr double kit_ml_rate = 12.5;   ///< frames per second of KIT-ML's joint positions

/// The 22 joints of HumanML3D (Guo et al. 2022), those of the SMPL body, in the order of its arrays
/// [frames, 22, 3]: metres, y up. Names and parents only; offsets are zero (see with_offsets_of).
inline const Skeleton& humanml3d_skeleton() {
  static const Skeleton skeleton = [] {
    constexpr std::array<int, 22> parents{-1, 0, 0, 0, 1,  2,  3,  4,  5,  6,  7,
                                          8,  9, 9, 9, 12, 13, 14, 16, 17, 18, 19};
    Skeleton out;
    for (std::size_t j = 0; j < parents.size(); ++j) {
      Joint joint;
      joint.name = smpl_body_joints[j];
      joint.parent = parents[j];
      out.joints.push_back(joint);
    }
    return out;
  }();
  return skeleton;
}

/// The 21 joints of KIT-ML (Plappert et al. 2016), in the order of the arrays [frames, 21, 3] that
/// HumanML3D's authors made of it: millimetres, y up. The arrays mirror the original recordings, so what the
/// recordings call left is on the right here; joints are called by the side on which they are. Names and
/// parents only; offsets are zero.
inline const Skeleton& kit_ml_skeleton() {
  static const Skeleton skeleton = [] {
    struct Entry {
      std::string_view name;
      int parent;
    };
    constexpr std::array<Entry, 21> entries{{{"root", -1},       {"pelvis", 0},        {"torso", 1},
                                             {"lower_neck", 2},  {"upper_neck", 3},    {"right_shoulder", 3},
                                             {"right_elbow", 5}, {"right_wrist", 6},   {"left_shoulder", 3},
                                             {"left_elbow", 8},  {"left_wrist", 9},    {"right_hip", 0},
                                             {"right_knee", 11}, {"right_ankle", 12},  {"right_midfoot", 13},
                                             {"right_foot", 14}, {"left_hip", 0},      {"left_knee", 16},
                                             {"left_ankle", 17}, {"left_midfoot", 18}, {"left_foot", 19}}};
    Skeleton out;
    for (const Entry& entry : entries) {
      Joint joint;
      joint.name = entry.name;
      joint.parent = entry.parent;
      out.joints.push_back(joint);
    }
    return out;
  }();
  return skeleton;
}

/// The skeleton of a data set whose joint positions have this number of joints: HumanML3D for 22, KIT-ML for
/// 21; none for others.
inline std::optional<Skeleton> known_skeleton(std::size_t joints) {
  if (joints == humanml3d_skeleton().size()) return humanml3d_skeleton();
  if (joints == kit_ml_skeleton().size()) return kit_ml_skeleton();
  return std::nullopt;
}

/// Throws Error as `name: ...` if an array of this shape holds the feature vectors of HumanML3D (263 numbers
/// per frame) or KIT-ML (251), which are not joint positions.
inline void refuse_feature_vectors(const std::vector<std::size_t>& shape, std::string_view name) {
  const bool features = shape.size() == 2 && (shape[1] == 263 || shape[1] == 251);
  require(!features, name, ": the shape is ", shape, ": these are feature vectors of ",
          features && shape[1] == 263 ? "HumanML3D" : "KIT-ML",
          " (new_joint_vecs), expected joint positions: give the files of the folder new_joints");
}

}  // namespace motiongan::motion
