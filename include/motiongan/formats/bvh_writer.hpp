// BVH writer. Values are written in the fewest digits that read back as the same double, so reading and
// rewriting a file keeps every number; motions are first rounded to six decimals, as is usual.
#pragma once
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/bvh_reader.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

namespace bvh_detail {

inline void append_number(std::string& out, double value) {
  // Without exponents, which some tools cannot read. 400 characters hold any double.
  std::array<char, 400> digits;
  const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), value == 0 ? 0.0 : value,
                                    std::chars_format::fixed);
  out.append(digits.data(), result.ptr);
}

inline void append_offset(std::string& out, const std::string& indent, const Vec3& offset) {
  out += indent + "OFFSET";
  for (const double v : offset) {
    require(std::isfinite(v), "an OFFSET of ", v, " cannot be written as BVH: it must be finite");
    out += ' ';
    append_number(out, v);
  }
  out += '\n';
}

/// Throws Error unless a reader would read this name back.
inline void check_name(const std::string& name) {
  const bool sound = !name.empty() && !is_blank(name.front()) && !is_blank(name.back()) &&
                     name.front() != '{' && name.back() != '{' && name.find_first_of("\r\n") == name.npos &&
                     name.find(" {") == name.npos && name.find("\t{") == name.npos;
  require(sound, "a joint called '", name,
          "' cannot be written as BVH: a name must not be empty, contain a line break, begin or end with a "
          "space, or have a brace at its start, at its end or after a space");
}

}  // namespace bvh_detail

/// The HIERARCHY part of a BVH file. Throws Error for names, offsets or joint orders that BVH cannot hold.
inline std::string format_hierarchy(const Skeleton& skeleton) {
  constexpr std::array<std::string_view, 6> names{"Xposition", "Yposition", "Zposition",
                                                  "Xrotation", "Yrotation", "Zrotation"};
  require(skeleton.size() > 0, "a skeleton without joints cannot be written as BVH");
  std::string out = "HIERARCHY\n";
  std::vector<int> open;  // joints with open braces
  const auto indent = [&] { return std::string(open.size(), '\t'); };
  const auto close = [&] {
    const Joint& joint = skeleton.joints[static_cast<std::size_t>(open.back())];
    if (joint.end_site) {
      out += indent() + "End Site\n" + indent() + "{\n";
      bvh_detail::append_offset(out, indent() + "\t", *joint.end_site);
      out += indent() + "}\n";
    }
    open.pop_back();
    out += indent() + "}\n";
  };
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const Joint& joint = skeleton.joints[j];
    while (!open.empty() && open.back() != joint.parent) close();
    // BVH is depth-first; another order would renumber the channels.
    require(!open.empty() || (j == 0 && joint.parent == -1), "joint '", joint.name, "' has parent ",
            joint.parent, ", which is not on the branch before it: BVH needs one root and depth-first order");
    bvh_detail::check_name(joint.name);
    out += indent() + (j == 0 ? "ROOT " : "JOINT ") + joint.name + '\n' + indent() + "{\n";
    open.push_back(static_cast<int>(j));
    require(open.size() <= bvh_detail::max_depth, "joint '", joint.name, "' is nested more than ",
            bvh_detail::max_depth, " deep");
    bvh_detail::append_offset(out, indent(), joint.offset);
    out += indent() + "CHANNELS " + std::to_string(joint.channels.size());
    for (const Channel c : joint.channels) out.append(" ").append(names[static_cast<std::size_t>(c)]);
    out += '\n';
  }
  while (!open.empty()) close();
  return out;
}

namespace bvh_detail {

/// A BVH file up to its frames. `id` is what messages call the clip.
inline std::string format_header(const Skeleton& skeleton, std::size_t frames, double frame_time,
                                 const std::string& id) {
  require(std::isfinite(frame_time) && frame_time >= 1e-6, "clip '", id, "' has a frame time of ", frame_time,
          " seconds, expected at least 0.000001");
  require(skeleton.channel_count() > 0 || frames == 0, "clip '", id, "' has frames but no channels");
  std::string out = format_hierarchy(skeleton);
  out += "MOTION\nFrames: " + std::to_string(frames) + "\nFrame Time: ";
  append_number(out, frame_time);
  out += '\n';
  return out;
}

/// Throws Error unless all channels [frames, width] are finite; the first row is frame `first` of clip `id`.
inline void check_finite(std::span<const double> channels, std::size_t width, std::size_t first,
                         const std::string& id) {
  for (std::size_t i = 0; i < channels.size(); ++i)
    require(std::isfinite(channels[i]), "clip '", id, "', frame ", first + i / width + 1, ", channel ",
            i % width + 1, " is ", channels[i], "; BVH holds finite numbers only");
}

/// Appends channels [frames, width], one line per frame.
inline void append_frames(std::string& out, std::span<const double> channels, std::size_t width) {
  for (std::size_t i = 0; i < channels.size(); ++i) {
    append_number(out, channels[i]);
    out += (i + 1) % width == 0 ? '\n' : ' ';
  }
}

/// Rounds to six decimals, as motions are written.
inline void round_channels(std::vector<double>& channels) {
  for (double& v : channels)
    if (std::abs(v) < 1e9) v = std::round(v * 1e6) / 1e6;
}

}  // namespace bvh_detail

/// The whole BVH text of a clip; every number reads back as the same double. Throws Error for a clip that BVH
/// cannot hold.
inline std::string format_bvh(const Clip& clip) {
  const std::size_t width = clip.skeleton.channel_count();
  require(clip.channels.size() == clip.frames * width, "clip '", clip.id, "' has ", clip.channels.size(),
          " values, expected ", clip.frames, " frames x ", width, " channels");
  std::string out = bvh_detail::format_header(clip.skeleton, clip.frames, clip.frame_time, clip.id);
  out.reserve(out.size() + clip.channels.size() * 11);
  bvh_detail::check_finite(clip.channels, width, 0, clip.id);
  bvh_detail::append_frames(out, clip.channels, width);
  return out;
}

/// Writes format_bvh(clip); `path` never holds a partial file.
inline void write_bvh(const std::filesystem::path& path, const Clip& clip) {
  write_text_atomically(path, format_bvh(clip));
}

/// The BVH text of a motion in its skeleton's own channels, rounded to six decimals (degrees and length
/// units). `id` names it in errors.
inline std::string format_bvh(const Motion& motion, std::string id) {
  Clip clip = to_clip(motion, std::move(id));
  bvh_detail::round_channels(clip.channels);
  return format_bvh(clip);
}

/// Writes format_bvh(motion), as above.
inline void write_bvh(const std::filesystem::path& path, const Motion& motion) {
  write_text_atomically(path, format_bvh(motion, path.stem().string()));
}

}  // namespace motiongan::motion
