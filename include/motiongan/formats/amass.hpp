// Motions of AMASS (Mahmood et al. 2019): .npz files with the pose parameters of the SMPL body models.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/mean_body.hpp"
#include "motiongan/formats/npz.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/formats/zip_archive.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

namespace amass_detail {

/// The parameters of a pose: which of them are the hands'.
struct PoseLayout {
  std::size_t width;       ///< numbers per frame, three for each joint
  std::size_t first_hand;  ///< joint index of the first of the 30 hand joints; 0 if there are none
};

// SMPL's last two joints (one per hand) and SMPL-X's jaw and eyes are skipped.
constexpr PoseLayout layouts[] = {{66, 0}, {72, 0}, {156, 22}, {165, 25}};

/// For every joint of the skeleton, its index in the pose parameters.
inline std::vector<std::size_t> pose_indices(const Skeleton& skeleton, std::size_t first_hand) {
  std::vector<std::size_t> out(skeleton.size(), 0);
  const auto place = [&](const std::string& name, std::size_t index) {
    if (const int joint = skeleton.find(name); joint >= 0) out[static_cast<std::size_t>(joint)] = index;
  };
  for (std::size_t i = 0; i < smpl_body_joints.size(); ++i) place(std::string(smpl_body_joints[i]), i);
  for (std::size_t i = 0; i < smpl_hand_joints.size(); ++i) {
    place("left_" + std::string(smpl_hand_joints[i]), first_hand + i);
    place("right_" + std::string(smpl_hand_joints[i]), first_hand + smpl_hand_joints.size() + i);
  }
  return out;
}

inline double read_rate(const ZipArchive& archive, std::string_view name) {
  const char* const key =
      archive.find("mocap_framerate.npy") == nullptr && archive.find("mocap_frame_rate.npy") != nullptr
          ? "mocap_frame_rate"
          : "mocap_framerate";
  const NpyArray rate = npz_array(archive, key, name);
  require(rate.values.size() == 1 && std::isfinite(rate.values[0]) && rate.values[0] > 0, name, ": '", key,
          "' has the shape ", rate.shape, rate.values.empty() ? "" : " and begins with ",
          rate.values.empty() ? "" : concat(rate.values[0]), ", expected one number above 0");
  return rate.values[0];
}

}  // namespace amass_detail

/// Reads an .npz file of AMASS: `poses` [frames, 66, 72, 156 or 165] (axis-angle vectors of the joints of
/// SMPL, SMPL-H or SMPL-X), `trans` [frames, 3] (metres, z up) and `mocap_framerate` or `mocap_frame_rate`.
/// The skeleton is mean_body_skeleton: the subject's shape (`betas`) is not used, since it means nothing
/// without the licensed body model. The world is turned to y up; the pelvis lies at `trans`, which in the
/// models differs from it by a constant vector (about 0.2 m sideways, a few centimetres in height). `name`
/// prefixes messages. Throws Error as `name: ...` for other arrays and values that are not finite.
inline Motion parse_amass(std::string_view bytes, const std::string& name) {
  const ZipArchive archive(bytes, name);
  const NpyArray poses = npz_array(archive, "poses", name), trans = npz_array(archive, "trans", name);
  const auto* const layout =
      std::find_if(std::begin(amass_detail::layouts), std::end(amass_detail::layouts),
                   [&](const auto& l) { return poses.shape.size() == 2 && poses.shape[1] == l.width; });
  require(layout != std::end(amass_detail::layouts), name, ": 'poses' has the shape ", poses.shape,
          ", expected [frames, 156] (SMPL-H), 165 (SMPL-X), 72 (SMPL) or 66 (body only)");
  const std::size_t frames = poses.shape[0], width = layout->width;
  require(trans.shape == std::vector<std::size_t>{frames, 3}, name, ": 'trans' has the shape ", trans.shape,
          ", expected [", frames, ", 3] as 'poses' has ", frames, " frames");
  require(frames > 0, name, ": found no frames, expected at least one");

  Motion out;
  out.skeleton = mean_body_skeleton(layout->first_hand > 0);
  out.rate = amass_detail::read_rate(archive, name);
  out.frames = frames;
  const std::vector<std::size_t> index = amass_detail::pose_indices(out.skeleton, layout->first_hand);
  const Quat upright = axis_rotation(0, -pi / 2);  // z up to y up
  const auto check = [&](std::size_t frame, const Vec3& v, std::string_view what) {
    for (const double x : v)
      require(std::isfinite(x), name, ": frame ", frame + 1, ", ", what, ": found ", x,
              ", expected a finite number");
  };
  for (std::size_t f = 0; f < frames; ++f) {
    for (std::size_t j = 0; j < out.skeleton.size(); ++j) {
      const double* const v = &poses.values[f * width + 3 * index[j]];
      const Vec3 turn{v[0], v[1], v[2]};
      check(f, turn, out.skeleton.joints[j].name);
      const Quat q = quat_from_expmap(turn);
      out.rotations.push_back(j == 0 ? multiply(upright, q) : q);
      out.positions.push_back(out.skeleton.joints[j].offset);
    }
    const double* const t = &trans.values[3 * f];
    check(f, {t[0], t[1], t[2]}, "trans");
    out.position(f, 0) = {t[0], t[2], -t[1]};
  }
  return out;
}

/// As parse_amass, from a file. Throws Error also if the file cannot be read.
inline Motion read_amass(const std::filesystem::path& path) {
  return parse_amass(read_text(path, "AMASS file"), path.string());
}

}  // namespace motiongan::motion
