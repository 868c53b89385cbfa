// A MotionFormat as JSON, the part of a model file that gives meaning to its values.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/motion_format.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/io/fields_json.hpp"

namespace motiongan::io {

namespace motion_format_detail {

/// Whether the value is a non-negative integer, signed or unsigned in the JSON.
inline bool is_count(const nlohmann::json& value) {
  return value.is_number_unsigned() || (value.is_number_integer() && value.get<long long>() >= 0);
}

/// The member `key` as a T. Throws Error if it is missing or of another type.
template <class T>
T read(const nlohmann::json& json, const char* key, const char* expected) {
  const auto at = json.find(key);
  require(at != json.end(), "the motion format has no '", key, "', expected ", expected);
  bool fits = true;
  if constexpr (std::is_same_v<T, bool>)
    fits = at->is_boolean();
  else if constexpr (std::is_same_v<T, double>)
    fits = at->is_number();
  else if constexpr (std::is_same_v<T, std::size_t>)
    fits = is_count(*at);
  else if constexpr (std::is_same_v<T, std::string>)
    fits = at->is_string();
  else {
    fits = at->is_array();
    if (fits)
      for (const nlohmann::json& item : *at)
        fits = fits && (std::is_same_v<typename T::value_type, double>        ? item.is_number()
                        : std::is_same_v<typename T::value_type, std::size_t> ? is_count(item)
                                                                              : item.is_string());
  }
  require(fits, "the motion format's '", key, "' is ", at->type_name(), ", expected ", expected);
  return at->get<T>();
}

}  // namespace motion_format_detail

/// Adds "unit_metres" and "clips_up" where they are not the defaults: older files lack them.
inline void space_to_json(const motion::ClipSpace& space, nlohmann::json& json) {
  if (space.unit_metres > 0) json["unit_metres"] = space.unit_metres;
  if (space.clips_up != motion::UpAxis::y) json["clips_up"] = name_of(space.clips_up);
}

/// Reads what space_to_json() added. Throws Error for a value of the wrong type or out of range.
inline motion::ClipSpace space_from_json(const nlohmann::json& json) {
  motion::ClipSpace out;
  if (json.contains("unit_metres"))
    out.unit_metres = motion_format_detail::read<double>(json, "unit_metres", "metres per unit");
  require(out.unit_metres >= 0, "the format's unit_metres is ", out.unit_metres, ", expected at least 0");
  if (json.contains("clips_up"))
    out.clips_up = enum_from<motion::UpAxis>(
        motion_format_detail::read<std::string>(json, "clips_up", "\"y\" or \"z\""), "the format's clips_up");
  return out;
}

/// {"skeleton": HIERARCHY text, "root": joint name, "root_position", "root_rotation": "expmap", "heading",
/// "velocity" or "support", "rate", "frames", "mean": [full dof], "std": [full dof], "relative_dims": [...],
/// "vocabulary": [words]}, with "support" "floor", and, if known, "descriptions", the training range "low"
/// and "high": [kept dof], and "unit_metres" and "clips_up". Every number round-trips exactly. Throws Error
/// for an inconsistent format.
inline nlohmann::json to_json(const motion::MotionFormat& format) {
  format.check();
  nlohmann::json json;
  json["skeleton"] = motion::format_hierarchy(format.skeleton());
  json["root"] = format.skeleton().joints[format.layout.root()].name;
  json["root_position"] = format.layout.root_position();
  json["root_rotation"] = std::string(name_of(format.layout.root_rotation()));
  json["rate"] = format.rate;
  json["frames"] = format.frames;
  json["mean"] = format.normalizer.mean();
  json["std"] = format.normalizer.std();
  json["relative_dims"] = format.relative_dims;
  json["vocabulary"] = format.vocabulary.words();
  space_to_json(format.space, json);
  if (!format.descriptions.empty()) json["descriptions"] = format.descriptions;
  if (format.layout.floor()) json["floor"] = *format.layout.floor();
  if (!format.low.empty()) {
    json["low"] = format.low;
    json["high"] = format.high;
  }
  return json;
}

/// Inverse of to_json. Throws Error, naming the member, if one is missing, of another type or inconsistent
/// with the rest.
inline motion::MotionFormat motion_format_from_json(const nlohmann::json& json) {
  using motion_format_detail::read;
  require(json.is_object(), "a motion format is ", json.type_name(), ", expected a JSON object");
  motion::MotionFormat format;
  motion::Skeleton skeleton =
      motion::parse_hierarchy(read<std::string>(json, "skeleton", "HIERARCHY text"), "skeleton of the model");
  const auto root_name = read<std::string>(json, "root", "a joint's name");
  const int root = skeleton.find(root_name);
  require(root >= 0, "the motion format's root '", root_name, "' is not a joint of its skeleton");
  const auto root_rotation = enum_from<motion::RootRotation>(
      read<std::string>(json, "root_rotation", "\"expmap\", \"heading\", \"velocity\" or \"support\""),
      "the motion format's root_rotation");
  format.layout = motion::PoseLayout(std::move(skeleton), read<bool>(json, "root_position", "true or false"),
                                     static_cast<std::size_t>(root), root_rotation);
  if (json.contains("floor"))
    format.layout = format.layout.with_floor(read<double>(json, "floor", "a height in the clips' unit"));
  format.rate = read<double>(json, "rate", "frames per second");
  format.frames = read<std::size_t>(json, "frames", "a whole number, 1 or more");
  format.space = space_from_json(json);
  format.normalizer = motion::Normalizer(read<std::vector<double>>(json, "mean", "numbers"),
                                         read<std::vector<double>>(json, "std", "numbers"));
  format.relative_dims = read<std::vector<std::size_t>>(json, "relative_dims", "whole numbers");
  // Older files have no training range.
  if (json.contains("low") || json.contains("high")) {
    format.low = read<std::vector<double>>(json, "low", "numbers");
    format.high = read<std::vector<double>>(json, "high", "numbers");
    require(!format.low.empty(), "the motion format's 'low' is empty, expected a number per kept dimension");
  }
  format.vocabulary = motion::Vocabulary(read<std::vector<std::string>>(json, "vocabulary", "words"));
  if (json.contains("descriptions"))
    format.descriptions = read<std::vector<std::string>>(json, "descriptions", "texts");
  format.check();
  return format;
}

/// to_json as text, for a file's metadata.
inline std::string to_text(const motion::MotionFormat& format) { return to_json(format).dump(); }

/// Inverse of to_text. Throws Error; `where` names the file in the message.
inline motion::MotionFormat motion_format_from_text(const std::string& text, const std::string& where) {
  try {
    return motion_format_from_json(parse_object(text, "the motion format"));
  } catch (const Error& error) {
    throw Error(where, ": ", error.what());
  }
}

}  // namespace motiongan::io
