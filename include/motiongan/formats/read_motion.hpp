// Reading a motion from a file of any format, upright and in one form.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/amass.hpp"
#include "motiongan/formats/amc.hpp"
#include "motiongan/formats/bvh_reader.hpp"
#include "motiongan/formats/clip_files.hpp"
#include "motiongan/formats/clip_options.hpp"
#include "motiongan/formats/position_files.hpp"
#include "motiongan/formats/scene_files.hpp"
#include "motiongan/motion/body.hpp"
#include "motiongan/motion/first_frame.hpp"
#include "motiongan/motion/measured_bones.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/motion/position_rotations.hpp"
#include "motiongan/motion/root_joint.hpp"

namespace motiongan::motion {

/// A motion as read from a file: y up, without a T-pose before it.
struct LoadedMotion {
  Motion motion;
  std::optional<UpAxis> up;        ///< the file's up axis; unset: unknown, taken to be y
  std::size_t dropped = 0;         ///< frames removed at the start
  double unit_metres = 0;          ///< metres per unit, if the format or the options say so; 0: unknown
  MeasuredBones bones;             ///< bones that the file holds in position channels
  std::vector<std::string> notes;  ///< what was corrected or ignored, one sentence each
};

/// Joint positions as read from a file, y up.
struct LoadedPositions {
  PositionClip clip;
  std::optional<UpAxis> up;  ///< the file's up axis; unset: unknown, taken to be y
};

/// Whether a file holds joint positions rather than rotations, by its ending: .csv or .npy.
inline bool holds_positions(const std::filesystem::path& file) {
  const std::string extension = extension_of(file);
  return extension == ".csv" || extension == ".npy";
}

namespace read_motion_detail {

inline std::string percent(double fraction) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f %%", 100 * fraction);
  return text;
}

/// Notes on bones in position channels.
inline void note_bones(const Motion& motion, const MeasuredBones& bones, const std::string& file,
                       std::vector<std::string>& notes) {
  const auto name = [&](std::size_t j) { return "'" + motion.skeleton.joints[j].name + "'"; };
  if (!bones.measured.empty())
    notes.push_back(concat(file, ": the OFFSETs of ", bones.measured.size(), " joints, first ",
                           name(bones.measured.front()),
                           ", are not their bones, which are in position channels: measured there (median ",
                           bones.median, ", spread ", percent(bones.spread), ")"));
  if (!bones.displaced.empty())
    notes.push_back(concat(file, ": the position channels of ", bones.displaced.size(), " joints, first ",
                           name(bones.displaced.front()),
                           ", are near zero: taken for displacements from their OFFSETs"));
  if (bones.stretching.empty()) return;
  const StretchingBone* worst = &bones.stretching.front();
  for (const StretchingBone& bone : bones.stretching)
    if (bone.stretch > worst->stretch) worst = &bone;
  notes.push_back(concat(file, ": ", bones.stretching.size(),
                         bones.stretching.size() == 1 ? " bone stretches" : " bones stretch",
                         " by more than 5 %, ", name(worst->joint), " by ", percent(worst->stretch),
                         "; poses hold rotations, so bones get one length there"));
}

/// Takes the motion from its file's world to one with y up.
inline void stand_upright(LoadedMotion& out, const ClipOptions& options) {
  Motion& motion = out.motion;
  const auto root = static_cast<std::size_t>(moving_root(motion));
  out.up = options.up ? options.up : out.up ? out.up : detect_up_axis(motion, root);
  if (out.up == UpAxis::z) motion = from_z_up(std::move(motion));
  motion = with_world_root(std::move(motion), static_cast<int>(root));
}

/// Reads a file of rotations into out.motion.
inline void read_rotations(const std::filesystem::path& file, const ClipOptions& options, LoadedMotion& out) {
  const std::string extension = extension_of(file);
  if (extension == ".npz") {  // turned to y up already
    out.motion = read_amass(file);
    out.up = UpAxis::z;
    if (out.unit_metres <= 0) out.unit_metres = 1;
  } else if (extension == ".amc") {
    const AsfSkeleton asf = read_asf(options.bones.empty() ? find_asf(file) : options.bones);
    out.motion =
        parse_amc(read_text(file, "AMC file"), asf, options.fps > 0 ? options.fps : 120, file.string());
    if (out.unit_metres <= 0) out.unit_metres = asf.unit_metres.value_or(0);
  } else if (holds_scene(file)) {
    double unit = 0;
    out.motion = read_scene_motion(file, options.fps, unit, out.notes);
    if (out.unit_metres <= 0) out.unit_metres = unit;
    out.up = UpAxis::y;
  } else {
    Clip clip = read_bvh(file);
    out.notes = std::move(clip.notes);
    out.motion = to_motion(clip);
  }
}

/// Throws Error for a clip of more than 11 days: its rate is wrong, and resampling it would not end.
inline void check_duration(const std::filesystem::path& file, std::size_t frames, double rate) {
  constexpr double longest = 1e6;
  const double seconds = frames < 2 ? 0 : static_cast<double>(frames - 1) / rate;
  require(seconds <= longest, file.string(), ": ", frames, " frames at ", rate, " per second (", 1 / rate,
          " s each) last ", seconds, " s, expected at most ", longest,
          " s; is the frame time in another unit? --fps gives the rate");
}

/// Takes out.motion, as it is in the file, to the form that read_motion gives; `posed` is the number of posed
/// frames at its start if that is known.
inline void finish(const std::filesystem::path& file, const ClipOptions& options, LoadedMotion& out,
                   std::optional<std::size_t> posed) {
  if (options.fps > 0) out.motion.rate = options.fps;
  check_duration(file, out.motion.frames, out.motion.rate);
  out.unit_metres /= options.scale;
  out.dropped = posed ? drop_frames(out.motion, *posed) : drop_first_frames(out.motion, options.first_frame);
  if (options.scale != 1) out.motion = scaled(std::move(out.motion), options.scale);
  if (out.motion.frames == 0) return;
  out.bones = measure_bones(out.motion);
  if (extension_of(file) != ".npz") stand_upright(out, options);
  note_bones(out.motion, out.bones, file.string(), out.notes);
}

/// The clip with its joints in depth-first order, as BVH and models hold them.
inline PositionClip depth_first(PositionClip clip) {
  const std::size_t joints = clip.skeleton.size();
  const auto below = children(clip.skeleton);
  std::vector<std::size_t> order, open{0};
  while (!open.empty() && joints > 0) {
    order.push_back(open.back());
    open.pop_back();
    const std::vector<std::size_t>& next = below[order.back()];
    open.insert(open.end(), next.rbegin(), next.rend());
  }
  if (std::is_sorted(order.begin(), order.end())) return clip;
  std::vector<int> place(joints);
  for (std::size_t k = 0; k < joints; ++k) place[order[k]] = static_cast<int>(k);
  PositionClip out{clip.id, {}, clip.rate, clip.frames, {}};
  for (const std::size_t j : order) {
    Joint joint = clip.skeleton.joints[j];
    if (joint.parent >= 0) joint.parent = place[static_cast<std::size_t>(joint.parent)];
    out.skeleton.joints.push_back(std::move(joint));
  }
  for (std::size_t f = 0; f < clip.frames; ++f)
    for (const std::size_t j : order) out.positions.push_back(clip.positions[f * joints + j]);
  return out;
}

/// Puts a ClipPath for each animation in the place of files with several, and leaves out those without any.
/// What cannot be read stays, for its reader to say so.
inline void list_animations(std::vector<std::filesystem::path>& files) {
  std::vector<std::filesystem::path> out;
  for (std::filesystem::path& file : files) {
    std::error_code ignored;
    if (!holds_scene(file) || !std::filesystem::is_regular_file(file, ignored)) {
      out.push_back(std::move(file));
      continue;
    }
    try {
      const std::vector<std::filesystem::path> clips = clips_of_scene(file);
      out.insert(out.end(), clips.begin(), clips.end());
    } catch (const Error&) {
      out.push_back(std::move(file));
    }
  }
  files = std::move(out);
}

}  // namespace read_motion_detail

/// Reads joint positions (.csv, .npy). `rate` is that of a file which does not say and for which options.fps
/// is 0. The up axis is detected only where a standing body walks over the xy plane. Throws Error for a file
/// that cannot be read.
inline LoadedPositions read_positions(const std::filesystem::path& file, const ClipOptions& options,
                                      double rate) {
  LoadedPositions out;
  out.clip = read_position_file(file, options.bones, options.fps > 0 ? options.fps : rate);
  if (options.fps > 0) out.clip.rate = options.fps;
  read_motion_detail::check_duration(file, out.clip.frames, out.clip.rate);
  out.clip = read_motion_detail::depth_first(std::move(out.clip));
  out.up = options.up;
  if (!out.up) out.up = detect_up_axis(out.clip.skeleton, out.clip.positions);
  const double s = options.scale;
  for (Vec3& p : out.clip.positions) {
    if (out.up == UpAxis::z) p = {p[0], p[2], -p[1]};
    if (s != 1) p = scale(p, s);
  }
  if (out.up == UpAxis::z || s != 1)
    out.clip.skeleton = with_offsets_of(out.clip.skeleton, out.clip.positions);
  return out;
}

/// Reads a motion: .bvh; .amc, with its .asf file (options.bones, or find_asf); .npz of AMASS, z up by
/// definition; an animation of .glb, .vrm and .vrma, which "moves.glb#walk" names (options.fps is the rate
/// at which it is read); joint positions (.csv, .npy), from which rotations are computed. The result has y
/// up, no T-pose before it, its root's track in world coordinates, and bones measured where the file holds
/// them in position channels. Throws Error for a file that cannot be read.
inline LoadedMotion read_motion(const std::filesystem::path& file, const ClipOptions& options = {}) {
  namespace detail = read_motion_detail;
  LoadedMotion out;
  out.unit_metres = options.unit_metres;
  if (holds_positions(file)) {
    LoadedPositions positions = read_positions(file, options, 0);
    out.motion = motion_from_positions(positions.clip);
    out.up = positions.up;
    return out;
  }
  detail::read_rotations(file, options, out);
  detail::finish(file, options, out, std::nullopt);
  return out;
}

/// What inspect_motion() tells of a file.
struct InspectedMotion {
  LoadedMotion loaded;     ///< of a long BVH file, a sample of the frames
  std::size_t frames = 0;  ///< all frames of the motion
};

/// What read_motion() tells of a file, quickly: of a long BVH file, only a sample of frames is converted. The
/// skeleton, its axes and sizes, dropped frames and notes are those of read_motion() but for the sampling.
/// Throws Error as that does.
inline InspectedMotion inspect_motion(const std::filesystem::path& file, const ClipOptions& options = {}) {
  const std::string extension = extension_of(file);
  Clip clip;
  std::vector<std::size_t> sample;
  if (extension != ".npz" && extension != ".amc" && !holds_positions(file) && !holds_scene(file)) {
    clip = read_bvh(file);
    sample = sampled_frames(clip.frames);
  }
  InspectedMotion out;
  if (clip.skeleton.size() == 0) {
    out.loaded = read_motion(file, options);
    out.frames = out.loaded.motion.frames;
    return out;
  }
  const std::size_t width = clip.skeleton.channel_count(), all = clip.frames;
  if (!sample.empty()) {
    for (std::size_t k = 0; k < sample.size(); ++k)
      std::copy_n(clip.channels.begin() + static_cast<std::ptrdiff_t>(sample[k] * width), width,
                  clip.channels.begin() + static_cast<std::ptrdiff_t>(k * width));
    clip.frames = sample.size();
    clip.channels.resize(clip.frames * width);
  }
  out.loaded.unit_metres = options.unit_metres;
  out.loaded.notes = std::move(clip.notes);
  out.loaded.motion = to_motion(clip);
  read_motion_detail::check_duration(file, all, options.fps > 0 ? options.fps : out.loaded.motion.rate);
  const bool automatic = options.first_frame == FirstFrame::automatic && !sample.empty();
  const std::size_t posed = automatic ? t_pose_frames(out.loaded.motion, 2) : 0;
  read_motion_detail::finish(file, options, out.loaded, automatic ? std::optional(posed) : std::nullopt);
  out.frames = all - out.loaded.dropped;
  return out;
}

/// All motion files in a folder and its subfolders, sorted, except those in `without`; or the file itself:
/// .bvh, .amc, .npz, .npy, .csv whose first line names joint positions, and the animations of .glb, .vrm,
/// .vrma (and .fbx, see scene_readers()), each as a ClipPath where a file has several. Throws Error if there
/// are none.
inline std::vector<std::filesystem::path> find_motion_files(
    const std::filesystem::path& where, const std::vector<std::filesystem::path>& without = {}) {
  if (!ClipPath(where).animation.empty()) return {where};
  std::vector<std::string_view> extensions{".bvh", ".amc", ".npz", ".npy", ".csv"};
  for (const auto& [extension, reader] : scene_readers()) extensions.push_back(extension);
  std::vector<std::filesystem::path> out = find_clip_files(where, extensions, without);
  std::error_code problem;
  if (!std::filesystem::is_directory(where, problem)) {
    if (!holds_scene(where)) return out;
    out = clips_of_scene(where);
    return out.empty() ? std::vector{where} : out;
  }
  read_motion_detail::list_animations(out);
  std::erase_if(out, [](const std::filesystem::path& file) {
    const std::string name = file.filename().string();
    if (name == "shape.npz" || name.ends_with("_shape.npz")) return true;  // AMASS's body shapes
    if (extension_of(file) != ".csv") return false;
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) return true;  // opening a pipe would wait
    std::ifstream in(file, std::ios::binary);
    std::string head(65536, '\0');
    in.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(in.gcount()));
    return !is_position_csv(head);  // a log, captions or labels
  });
  require(!out.empty(), "folder ", where.string(),
          " and its subfolders have no motion file (.bvh, .amc, .npz, .npy, .glb with animations, or .csv of "
          "joint positions)");
  return out;
}

}  // namespace motiongan::motion
