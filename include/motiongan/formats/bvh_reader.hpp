// BVH reader for any skeleton and any channels; every error gives its place in the file.
#pragma once
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/bvh_cursor.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

namespace bvh_detail {

inline constexpr std::size_t max_depth = 1000;  // deeper nesting means a broken file

/// Parses `Xposition` etc., ignoring case; returns false for other words.
inline bool channel_from_name(std::string_view word, Channel& out) {
  constexpr std::string_view names[] = {"Xposition", "Yposition", "Zposition",
                                        "Xrotation", "Yrotation", "Zrotation"};
  for (std::size_t i = 0; i < 6; ++i) {
    if (!same_word(word, names[i])) continue;
    out = static_cast<Channel>(i);
    return true;
  }
  return false;
}

inline Vec3 read_offset(Cursor& in) {
  in.expect("OFFSET", "");
  const double x = in.number("the x of an OFFSET");
  const double y = in.number("the y of an OFFSET");
  return {x, y, in.number("the z of an OFFSET")};
}

inline std::vector<Channel> read_channels(Cursor& in, const std::string& joint) {
  in.expect("CHANNELS", "");
  in.skip_space();
  const std::size_t place = in.place();
  const std::size_t n = in.count("the number of channels");
  if (n > 6) in.fail_at(place, "joint '", joint, "' has ", n, " channels, expected at most 6");
  std::vector<Channel> out;
  std::size_t turns = 0;
  while (out.size() < n) {
    const std::string_view word = in.peek();
    Channel c{};
    if (!channel_from_name(word, c))
      in.fail_at(in.place(), "found ", Cursor::quoted(word), ", expected channel ", out.size() + 1, " of ", n,
                 " of joint '", joint,
                 "': Xposition, Yposition, Zposition, Xrotation, Yrotation or Zrotation");
    if (!is_rotation(c) && std::find(out.begin(), out.end(), c) != out.end())
      in.fail_at(in.place(), "found ", Cursor::quoted(word),
                 " a second time, expected each position channel of joint '", joint, "' once");
    turns += is_rotation(c);
    if (turns > 3)
      in.fail_at(in.place(), "found a fourth rotation channel of joint '", joint,
                 "', expected at most three");
    out.push_back(c);
    in.next();
  }
  Channel extra{};
  if (channel_from_name(in.peek(), extra))
    in.fail_at(in.place(), "found ", Cursor::quoted(in.peek()), ", expected only ", n, " channels of joint '",
               joint, "' as its CHANNELS line says");
  return out;
}

/// A joint whose braces are open.
struct Open {
  int joint = 0;
  bool has_offset = false, has_channels = false, has_child = false;
};

/// Reads HIERARCHY up to the root's closing brace. Open joints are kept on an explicit stack, so deep nesting
/// cannot overflow the call stack.
inline Skeleton read_hierarchy(Cursor& in) {
  in.expect("HIERARCHY", " (is this a BVH file?)");
  in.expect("ROOT", "");
  Skeleton skeleton;
  std::vector<Open> open;
  std::unordered_set<std::string> names;

  const auto begin_joint = [&](int parent) {
    in.skip_blanks();
    const std::size_t place = in.place();
    Joint joint;
    joint.name = std::string(in.rest_of_name());
    joint.parent = parent;
    if (joint.name.empty()) in.fail_at(place, "found no name, expected a joint's name after ROOT or JOINT");
    // Joints are looked up by name, so names must be unique.
    if (!names.insert(joint.name).second)
      in.fail_at(place, "found a second joint called '", joint.name,
                 "', expected every joint to have its own name");
    if (open.size() >= max_depth)
      in.fail_at(place, "joint '", joint.name, "' is nested ", open.size() + 1, " deep, expected at most ",
                 max_depth);
    in.expect("{", concat(" after the name of joint '", joint.name, "'"));
    skeleton.joints.push_back(std::move(joint));
    open.push_back({static_cast<int>(skeleton.size()) - 1});
  };

  begin_joint(-1);
  while (!open.empty()) {
    Open& top = open.back();
    const auto current = static_cast<std::size_t>(top.joint);
    const std::string name = skeleton.joints[current].name;
    const std::string_view word = in.peek();
    const std::size_t place = in.place();
    if (same_word(word, "OFFSET")) {
      if (top.has_offset) in.fail_at(place, "found a second OFFSET of joint '", name, "', expected one");
      skeleton.joints[current].offset = read_offset(in);
      top.has_offset = true;
    } else if (same_word(word, "CHANNELS")) {
      if (top.has_channels || top.has_child)
        in.fail_at(place, "found CHANNELS of joint '", name, "' ",
                   top.has_child ? "after its children" : "twice",
                   ", expected one CHANNELS line before its first child");
      skeleton.joints[current].channels = read_channels(in, name);
      top.has_channels = true;
    } else if (same_word(word, "JOINT")) {
      in.next();
      top.has_child = true;
      begin_joint(top.joint);
    } else if (same_word(word, "End")) {
      in.next();
      in.expect("Site", " after End");
      in.expect("{", " after End Site");
      if (skeleton.joints[current].end_site)
        in.fail_at(place, "found a second End Site of joint '", name, "', expected at most one");
      skeleton.joints[current].end_site = read_offset(in);
      in.expect("}", " after the OFFSET of an End Site");
    } else if (word == "}") {
      if (!top.has_offset) in.fail_at(place, "joint '", name, "' ends without OFFSET, expected one");
      in.next();
      open.pop_back();
    } else {
      in.fail_at(place, "found ", Cursor::quoted(word), " in joint '", name,
                 "', expected OFFSET, CHANNELS, JOINT, End Site or }");
    }
  }
  if (same_word(in.peek(), "ROOT"))
    in.fail_at(in.place(), "found a second ROOT, expected MOTION: split the file into one file per skeleton");
  return skeleton;
}

}  // namespace bvh_detail

/// Reads the HIERARCHY part of a BVH text, which may end after it. `name` is what messages call the text.
/// Throws Error as `name:line:column: ...`.
inline Skeleton parse_hierarchy(std::string_view text, std::string name) {
  bvh_detail::Cursor in(text, std::move(name));
  Skeleton skeleton = bvh_detail::read_hierarchy(in);
  if (!in.peek().empty() && !bvh_detail::same_word(in.peek(), "MOTION"))
    in.fail_at(in.place(), "found ", bvh_detail::Cursor::quoted(in.peek()),
               ", expected MOTION or the end of the text");
  return skeleton;
}

/// Reads a whole BVH text, one frame per line; `name` becomes the clip's id and prefixes messages. Throws
/// Error as `name:line:column: what was found, what was expected`; the column counts bytes.
inline Clip parse_bvh(std::string_view text, std::string name) {
  using bvh_detail::Cursor;
  Cursor in(text, name);
  Clip clip;
  clip.id = std::move(name);
  clip.skeleton = bvh_detail::read_hierarchy(in);
  const std::size_t width = clip.skeleton.channel_count();
  in.expect("MOTION", " after the skeleton");
  in.expect_label("Frames:");
  in.skip_space();
  const std::size_t promise_place = in.place();
  const std::size_t promised = in.count("the number of frames");
  in.expect_label("Frame Time:");
  in.skip_space();
  const std::size_t time_place = in.place();
  clip.frame_time = in.number("the seconds between two frames");
  if (clip.frame_time < 1e-6)
    in.fail_at(time_place, "found a frame time of ", clip.frame_time, " seconds, expected at least 0.000001");
  if (width == 0 && promised > 0)
    in.fail_at(promise_place, "the skeleton has no channels but ", promised, " frames, expected channels");
  if (!in.at_line_end())
    in.fail_at(in.place(), "found ", Cursor::quoted(in.peek()),
               ", expected the end of the line after the frame time");

  // A number takes at least two bytes: do not reserve memory for more frames than the file can hold.
  if (width > 0)
    clip.channels.reserve(promised <= in.left() / (2 * width) + 1 ? promised * width : in.left() / 2 + width);
  for (in.skip_space(); !in.at_end(); in.skip_space()) {
    const std::size_t start = in.place();
    if (clip.frames == promised)
      in.fail_at(start, "found frame ", promised + 1, ", expected ", promised, " as the line 'Frames:' says");
    for (std::size_t i = 0; i < width; ++i) {
      if (in.at_line_end())
        in.fail_at(in.place(), "frame ", clip.frames + 1, " has ", i, " values, expected ", width);
      clip.channels.push_back(in.number_here("a channel's value"));
    }
    if (!in.at_line_end()) {
      std::size_t extra = 0;
      const std::size_t place = in.place();
      for (; !in.at_line_end(); ++extra) in.next();
      in.fail_at(place, "frame ", clip.frames + 1, " has ", width + extra, " values, expected ", width);
    }
    ++clip.frames;
  }
  if (clip.frames < promised)
    in.fail_at(in.place(), "found the end of the file after ", clip.frames, " frames, expected ", promised,
               " as the line 'Frames:' says");
  return clip;
}

/// Reads a BVH file; the clip's id is the file name without folder and extension. Throws Error if the file
/// cannot be read or parsed.
inline Clip read_bvh(const std::filesystem::path& path) {
  const std::string text = read_text(path, "BVH file");
  Clip clip = parse_bvh(text, path.string());
  clip.id = path.stem().string();
  return clip;
}

}  // namespace motiongan::motion
