// A MotionFormat as JSON: the part of a model file that says what its numbers mean.
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
#include "motiongan/formats/bvh.hpp"
#include "motiongan/data/motion_format.hpp"

namespace motiongan::io {

namespace motion_format_detail {

/// In the order of motion::RootRotation.
inline constexpr std::array<std::string_view, 3> root_rotation_names{"expmap", "heading", "velocity"};

}  // namespace motion_format_detail

/// {"skeleton": HIERARCHY text, "root": joint name, "root_position", "root_rotation": "expmap", "heading"
/// or "velocity", "rate", "frames", "mean": [full dof], "std": [full dof], "relative_dims": [...],
/// "vocabulary": [words]}, and, where the training range is known, "low" and "high": [kept dof]; every number
/// comes back exactly.
inline nlohmann::json to_json(const motion::MotionFormat& format) {
  format.check();
  nlohmann::json json = {{"skeleton", motion::format_hierarchy(format.skeleton())},
                         {"root", format.skeleton().joints[format.layout.root()].name},
                         {"root_position", format.layout.root_position()},
                         {"root_rotation", motion_format_detail::root_rotation_names.at(
                                               static_cast<std::size_t>(format.layout.root_rotation()))},
                         {"rate", format.rate},
                         {"frames", format.frames},
                         {"mean", format.normalizer.mean()},
                         {"std", format.normalizer.std()},
                         {"relative_dims", format.relative_dims},
                         {"vocabulary", format.vocabulary.words()}};
  if (!format.low.empty()) {
    json["low"] = format.low;
    json["high"] = format.high;
  }
  return json;
}

namespace motion_format_detail {

/// Whether the value is a whole number of at least 0, however it came into the JSON.
inline bool is_count(const nlohmann::json& value) {
  return value.is_number_unsigned() || (value.is_number_integer() && value.get<long long>() >= 0);
}

/// The member `key` as a T; Error if it is missing or something else.
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

/// The inverse of to_json. Error, naming the member, for anything that is missing, of another type or does
/// not fit the rest.
inline motion::MotionFormat motion_format_from_json(const nlohmann::json& json) {
  using motion_format_detail::read;
  require(json.is_object(), "a motion format is ", json.type_name(), ", expected a JSON object");
  motion::MotionFormat format;
  motion::Skeleton skeleton =
      motion::parse_hierarchy(read<std::string>(json, "skeleton", "HIERARCHY text"), "skeleton of the model");
  const auto root_name = read<std::string>(json, "root", "a joint's name");
  const int root = skeleton.find(root_name);
  require(root >= 0, "the motion format's root '", root_name, "' is not a joint of its skeleton");
  constexpr const char* forms = "\"expmap\", \"heading\" or \"velocity\"";
  const auto root_rotation = read<std::string>(json, "root_rotation", forms);
  const auto& names = motion_format_detail::root_rotation_names;
  const auto form = std::find(names.begin(), names.end(), root_rotation);
  require(form != names.end(), "the motion format's root_rotation is \"", root_rotation, "\", expected ",
          forms);
  format.layout = motion::PoseLayout(std::move(skeleton), read<bool>(json, "root_position", "true or false"),
                                     static_cast<std::size_t>(root),
                                     static_cast<motion::RootRotation>(form - names.begin()));
  format.rate = read<double>(json, "rate", "frames per second");
  format.frames = read<std::size_t>(json, "frames", "a whole number, 1 or more");
  format.normalizer = motion::Normalizer(read<std::vector<double>>(json, "mean", "numbers"),
                                         read<std::vector<double>>(json, "std", "numbers"));
  format.relative_dims = read<std::vector<std::size_t>>(json, "relative_dims", "whole numbers");
  // Files from before the range was kept have none.
  if (json.contains("low") || json.contains("high")) {
    format.low = read<std::vector<double>>(json, "low", "numbers");
    format.high = read<std::vector<double>>(json, "high", "numbers");
    require(!format.low.empty(), "the motion format's 'low' is empty, expected a number per kept dimension");
  }
  format.vocabulary = motion::Vocabulary(read<std::vector<std::string>>(json, "vocabulary", "words"));
  format.check();
  return format;
}

}  // namespace motiongan::io
