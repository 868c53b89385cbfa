// A PositionFormat as JSON, the part of a model file that gives meaning to its values.
#pragma once
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/motion_format_json.hpp"
#include "motiongan/data/position_format.hpp"
#include "motiongan/formats/bvh.hpp"

namespace motiongan::io {

/// {"skeleton": HIERARCHY text, "root_track", "rate", "frames", "mean": [full dof], "std": [full dof],
/// "classes": [names]}. Every number round-trips exactly. Throws Error for an inconsistent format.
inline nlohmann::json to_json(const motion::PositionFormat& format) {
  format.check();
  nlohmann::json json;
  json["skeleton"] = motion::format_hierarchy(format.skeleton());
  json["root_track"] = format.layout.root_track();
  json["rate"] = format.rate;
  json["frames"] = format.frames;
  json["mean"] = format.normalizer.mean();
  json["std"] = format.normalizer.std();
  json["classes"] = format.classes;
  space_to_json(format.space, json);
  return json;
}

/// Inverse of to_json. Throws Error, naming the member, if one is missing, of another type or inconsistent
/// with the rest.
inline motion::PositionFormat position_format_from_json(const nlohmann::json& json) {
  using motion_format_detail::read;
  require(json.is_object(), "a position format is ", json.type_name(), ", expected a JSON object");
  motion::PositionFormat format;
  motion::Skeleton skeleton =
      motion::parse_hierarchy(read<std::string>(json, "skeleton", "HIERARCHY text"), "skeleton of the model");
  format.layout =
      motion::PositionLayout(std::move(skeleton), read<bool>(json, "root_track", "true or false"));
  format.rate = read<double>(json, "rate", "frames per second");
  format.frames = read<std::size_t>(json, "frames", "a whole number, 1 or more");
  format.space = space_from_json(json);
  format.normalizer = motion::Normalizer(read<std::vector<double>>(json, "mean", "numbers"),
                                         read<std::vector<double>>(json, "std", "numbers"));
  format.classes = read<std::vector<std::string>>(json, "classes", "names");
  format.check();
  return format;
}

/// to_json as text, for a file's metadata.
inline std::string to_text(const motion::PositionFormat& format) { return to_json(format).dump(); }

/// Inverse of to_text. Throws Error; `where` names the file in the message.
inline motion::PositionFormat position_format_from_text(const std::string& text, const std::string& where) {
  try {
    return position_format_from_json(parse_object(text, "the position format"));
  } catch (const Error& error) {
    throw Error(where, ": ", error.what());
  }
}

}  // namespace motiongan::io
