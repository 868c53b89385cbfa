// Which joints of two skeletons are the same part of the body: as text, to be looked at and edited.
#pragma once
#include <filesystem>
#include <sstream>

#include "motiongan/formats/text_file.hpp"
#include "motiongan/io/atomic_file.hpp"
#include "motiongan/motion/body_parts.hpp"

namespace motiongan::motion {

/// The parts of the body that motion comes from, and of the body that it goes to.
struct JointMap {
  BodyParts from, to;
};

/// find_body() of both skeletons. Throws Error, saying which skeleton, if one of them is no body.
inline JointMap find_joint_map(const Skeleton& from, const Skeleton& to) {
  const auto parts = [](const Skeleton& skeleton, const char* which) {
    try {
      return find_body(skeleton);
    } catch (const Error& error) {
      throw Error(which, ": ", error.what());
    }
  };
  return {parts(from, "the skeleton that the motion comes from"),
          parts(to, "the skeleton that the motion goes to")};
}

/// The first line of a file that holds a map.
inline constexpr const char* joint_map_header = "part\tto\tfrom";

/// The map as lines of part, joint of the skeleton that the motion goes to, and joint of the one that it
/// comes from, separated by tabs. A part that only one of them has, or has more joints of, leaves the other
/// empty.
inline std::string joint_map_text(const JointMap& map, const Skeleton& from, const Skeleton& to) {
  std::string out = concat(joint_map_header, "\n");
  const auto joints_of = [](const BodyParts& body, BodyPart part) {
    const auto at = body.find(part);
    return at == body.end() ? std::vector<std::size_t>{} : at->second;
  };
  for (const auto& [part, name] : enum_names(BodyPart{})) {
    const std::vector<std::size_t> a = joints_of(map.to, part), b = joints_of(map.from, part);
    for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i)
      out += concat(name, "\t", i < a.size() ? to.joints[a[i]].name : "", "\t",
                    i < b.size() ? from.joints[b[i]].name : "", "\n");
  }
  return out;
}

/// Writes joint_map_text() to a file, replacing it at once.
inline void write_joint_map(const std::filesystem::path& path, const JointMap& map, const Skeleton& from,
                            const Skeleton& to) {
  io::AtomicFile file(path);
  file.write(joint_map_text(map, from, to));
  file.commit();
}

/// Reads a map that write_joint_map() wrote, perhaps edited: lines may be left out, changed or in another
/// order; empty ones and those that begin with # do not count. Throws Error, naming file and line, for an
/// unknown part or joint, and for a body without hips or without a leg down to the foot.
inline JointMap read_joint_map(const std::filesystem::path& path, const Skeleton& from, const Skeleton& to) {
  JointMap map;
  std::istringstream lines(read_text(path, "map of joints", largest_list_file));
  std::string line;
  for (std::size_t number = 1; std::getline(lines, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line.front() == '#' || line == joint_map_header) continue;
    const std::string where = concat(path.string(), ":", number, ": ");
    std::vector<std::string> cells(1);
    for (const char c : line) c == '\t' ? static_cast<void>(cells.emplace_back()) : cells.back().push_back(c);
    require(cells.size() <= 3, where, cells.size(), " columns, expected a part and two joints");
    cells.resize(3);
    std::optional<BodyPart> part;
    std::string known;
    for (const auto& [value, name] : enum_names(BodyPart{})) {
      if (cells[0] == name) part = value;
      known += concat(known.empty() ? "" : ", ", name);
    }
    require(part.has_value(), where, "there is no part '", cells[0], "'; the parts are: ", known);
    const auto add = [&](BodyParts& body, const Skeleton& skeleton, const std::string& name,
                         const char* which) {
      if (name.empty()) return;
      const int joint = skeleton.find(name);
      require(joint >= 0, where, "the skeleton that the motion ", which, " has no joint '", name,
              "'; its joints are: ", feet_detail::joint_names(skeleton));
      body[*part].push_back(static_cast<std::size_t>(joint));
    };
    add(map.to, to, cells[1], "goes to");
    add(map.from, from, cells[2], "comes from");
  }
  for (const auto& [body, which] : {std::pair{&map.from, "comes from"}, std::pair{&map.to, "goes to"}})
    for (const BodyPart part :
         {BodyPart::hips, BodyPart::left_thigh, BodyPart::left_shin, BodyPart::left_foot,
          BodyPart::right_thigh, BodyPart::right_shin, BodyPart::right_foot})
      require(body->contains(part), path.string(), ": the skeleton that the motion ", which,
              " has no joint for the ", name_of(part));
  return map;
}

}  // namespace motiongan::motion
