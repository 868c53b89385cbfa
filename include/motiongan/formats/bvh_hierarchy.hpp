// The HIERARCHY part of BVH files: joints, offsets and channels.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/bvh_cursor.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

namespace bvh_detail {

inline constexpr std::size_t max_depth = 1000;  // deeper nesting means a broken file

/// Names of channels: the six of Channel, in its order, then scale.
inline constexpr std::array<std::string_view, 9> channel_names{"Xposition", "Yposition", "Zposition",
                                                               "Xrotation", "Yrotation", "Zrotation",
                                                               "Xscale",    "Yscale",    "Zscale"};

/// Index of a channel in channel_names, ignoring case, or its size for other words.
inline std::size_t channel_from_name(std::string_view word) {
  std::size_t i = 0;
  while (i < channel_names.size() && !same_word(word, channel_names[i])) ++i;
  return i;
}

/// Things of one kind that the reader corrects or ignores: their number, and the first one.
struct Tally {
  std::size_t count = 0, place = 0;
  std::string first;

  void add(std::size_t at, const std::string& example) {
    if (count++ == 0) place = at, first = example;
  }
};

/// What read_hierarchy finds.
struct Hierarchy {
  Skeleton skeleton;
  std::vector<char> kept;  ///< per value of a frame in the file, whether it is a channel of `skeleton`
  std::vector<std::string> notes;  ///< see Clip::notes
};

inline Vec3 read_offset(Cursor& in) {
  in.expect("OFFSET", "");
  const double x = in.number("the x of an OFFSET");
  const double y = in.number("the y of an OFFSET");
  return {x, y, in.number("the z of an OFFSET")};
}

/// Reads a CHANNELS line. Scale channels are left out; `kept` gets one entry per channel of the line.
inline std::vector<Channel> read_channels(Cursor& in, const std::string& joint, std::vector<char>& kept) {
  in.expect("CHANNELS", "");
  in.skip_space();
  const std::size_t place = in.place();
  const std::size_t n = in.count("the number of channels");
  if (n > channel_names.size())
    in.fail_at(place, "joint '", joint, "' has ", n, " channels, expected at most ", channel_names.size());
  std::vector<Channel> out;
  std::array<bool, channel_names.size()> seen{};
  std::size_t turns = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::string_view word = in.peek();
    const std::size_t found = channel_from_name(word);
    if (found == channel_names.size())
      in.fail_at(in.place(), "found ", Cursor::quoted(word), ", expected channel ", i + 1, " of ", n,
                 " of joint '", joint,
                 "': Xposition, Yposition, Zposition, Xrotation, Yrotation or Zrotation");
    const bool scale = found >= 6, turn = !scale && is_rotation(static_cast<Channel>(found));
    if (!turn && seen[found])
      in.fail_at(in.place(), "found ", Cursor::quoted(word), " a second time, expected each ",
                 scale ? "scale" : "position", " channel of joint '", joint, "' once");
    turns += turn;
    if (turns > 3)
      in.fail_at(in.place(), "found a fourth rotation channel of joint '", joint,
                 "', expected at most three");
    seen[found] = true;
    kept.push_back(!scale);
    if (!scale) out.push_back(static_cast<Channel>(found));
    in.next();
  }
  if (channel_from_name(in.peek()) < channel_names.size())
    in.fail_at(in.place(), "found ", Cursor::quoted(in.peek()), ", expected only ", n, " channels of joint '",
               joint, "' as its CHANNELS line says");
  return out;
}

/// A joint whose braces are open.
struct Open {
  int joint = 0;
  bool has_offset = false, has_channels = false, has_child = false, more_sites = false;
};

/// A joint whose name an earlier joint has.
struct SameName {
  std::size_t joint = 0, place = 0;
};

/// Joints are looked up by name, so each joint of `same` gets the first free of name_2, name_3, ...; `names`
/// are those of all joints. Returns a note.
inline std::string rename_joints(const Cursor& in, Skeleton& skeleton, const std::vector<SameName>& same,
                                 std::unordered_set<std::string>& names) {
  std::unordered_map<std::string, std::size_t> last;  // number given last, by name
  std::string before, after;
  for (const SameName& s : same) {
    std::string& name = skeleton.joints[s.joint].name;
    std::size_t& number = last.try_emplace(name, 1).first->second;
    std::string free;
    do free = concat(name, "_", ++number);
    while (!names.insert(free).second);
    if (&s == &same.front()) before = name, after = free;
    name = std::move(free);
  }
  if (same.size() == 1)
    return in.note_at(same.front().place, "found a second joint called '", before, "'; it is renamed to '",
                      after, "'");
  return in.note_at(same.front().place, "found ", same.size(),
                    " joints with the name of an earlier joint; they are renamed, the first from '", before,
                    "' to '", after, "'");
}

/// The notes on channels and End Sites.
inline void add_hierarchy_notes(const Cursor& in, const Tally& scaled, const Tally& sites,
                                std::vector<std::string>& notes) {
  const auto first = [](const Tally& t) {
    return concat(t.count == 1 ? "joint '" : concat(t.count, " joints (the first is '"), t.first,
                  t.count == 1 ? "' has " : "') have ");
  };
  if (scaled.count > 0)
    notes.push_back(in.note_at(scaled.place, first(scaled),
                               "scale channels; scale is not motion, so their values are ignored"));
  if (sites.count > 0)
    notes.push_back(in.note_at(sites.place, first(sites), "more than one End Site; only the first is kept"));
}

/// Reads HIERARCHY up to the root's closing brace. Open joints are kept on an explicit stack, so deep nesting
/// cannot overflow the call stack.
inline Hierarchy read_hierarchy(Cursor& in) {
  in.expect("HIERARCHY", " (is this a BVH file?)");
  in.expect("ROOT", "");
  Hierarchy out;
  Skeleton& skeleton = out.skeleton;
  std::vector<Open> open;
  std::unordered_set<std::string> names;
  std::vector<SameName> same_names;
  Tally scaled, sites;

  const auto begin_joint = [&](int parent) {
    in.skip_blanks();
    const std::size_t place = in.place();
    Joint joint;
    joint.name = std::string(in.rest_of_name());
    joint.parent = parent;
    if (joint.name.empty()) in.fail_at(place, "found no name, expected a joint's name after ROOT or JOINT");
    if (!names.insert(joint.name).second) same_names.push_back({skeleton.size(), place});
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
      const std::size_t values = out.kept.size();
      skeleton.joints[current].channels = read_channels(in, name, out.kept);
      if (out.kept.size() - values > skeleton.joints[current].channels.size()) scaled.add(place, name);
      top.has_channels = true;
    } else if (same_word(word, "JOINT")) {
      in.next();
      top.has_child = true;
      begin_joint(top.joint);
    } else if (same_word(word, "End")) {
      in.next();
      in.expect("Site", " after End");
      in.skip_end_site_name();
      in.expect("{", " after End Site");
      const Vec3 site = read_offset(in);
      in.expect("}", " after the OFFSET of an End Site");
      if (!skeleton.joints[current].end_site)
        skeleton.joints[current].end_site = site;
      else if (!std::exchange(top.more_sites, true))
        sites.add(place, name);
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
  add_hierarchy_notes(in, scaled, sites, out.notes);
  if (!same_names.empty()) out.notes.push_back(rename_joints(in, skeleton, same_names, names));
  return out;
}

}  // namespace bvh_detail

}  // namespace motiongan::motion
