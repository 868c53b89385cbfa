// Caption files in JSON.
#pragma once
#include <cstddef>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "motiongan/core/error.hpp"
#include "motiongan/data/caption_file.hpp"
#include "motiongan/io/json_depth.hpp"

namespace motiongan::motion {

namespace caption_detail {

using OrderedJson = nlohmann::ordered_json;

/// The first of `names` that the object has, or nothing.
template <class Names>
const OrderedJson* member_of(const OrderedJson& object, const Names& names) {
  for (const std::string_view name : names)
    if (const auto at = object.find(std::string(name)); at != object.end()) return &*at;
  return nullptr;
}

/// Adds a caption or a list of captions.
inline void add_json_captions(CaptionFile& file, const std::string& id, const OrderedJson& value) {
  if (value.is_array()) {
    for (const OrderedJson& one : value) {
      require(one.is_string(), file.name, ": clip '", id, "' has the caption ", one.dump(),
              ", expected a string");
      add_caption(file, id, trimmed(one.get_ref<const std::string&>()), 0);
    }
    return;
  }
  require(value.is_string(), file.name, ": clip '", id, "' has the captions ", value.dump(),
          ", expected a string or a list of strings");
  add_caption(file, id, trimmed(value.get_ref<const std::string&>()), 0);
}

/// Adds the captions of [{"id": ..., "caption": ...}, ...].
inline void add_json_list(CaptionFile& file, const OrderedJson& list) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    const OrderedJson& one = list[i];
    require(one.is_object(), file.name, ": entry ", i, " is ", one.dump(), ", expected an object");
    const OrderedJson *const id = member_of(one, id_names), *const texts = member_of(one, text_names);
    require(id != nullptr, file.name, ": entry ", i,
            " has no clip id, expected \"id\", \"clip\", \"file\" or ", "\"name\"");
    require(id->is_string() || id->is_number_integer(), file.name, ": entry ", i, " has the clip id ",
            id->dump(), ", expected a string");
    require(
        texts != nullptr, file.name, ": entry ", i,
        " has no caption, expected \"caption\", \"text\" or \"description\", or \"captions\" or \"texts\"");
    add_json_captions(file, id->is_string() ? id->get<std::string>() : id->dump(), *texts);
  }
}

/// Parses the text. Throws Error, with nlohmann's line and column, for a syntax error, for deep nesting, and
/// for a clip that the top-level object has twice, of which the parser would keep only one.
inline OrderedJson parse_caption_document(std::string_view text, std::string_view name) {
  require(!io::nests_too_deeply(text), name, ": found more than ", io::most_nested_json,
          " lists or objects within each other, expected {\"clip\": [\"caption\", ...]}");
  std::set<std::string> keys;
  std::string twice;
  const auto check_key = [&](int depth, OrderedJson::parse_event_t event, OrderedJson& value) {
    if (depth == 1 && event == OrderedJson::parse_event_t::key &&
        !keys.insert(value.get<std::string>()).second)
      twice = value.get<std::string>();
    return true;
  };
  OrderedJson json;
  try {
    json = OrderedJson::parse(text.begin(), text.end(), check_key);
  } catch (const OrderedJson::exception& error) {
    const std::string_view what = error.what();
    const std::size_t tag = what.find("] ");
    throw Error(name, ": ", tag == what.npos ? what : what.substr(tag + 2), "; expected JSON in UTF-8");
  }
  require(twice.empty() || !json.is_object(), name, ": clip '", twice,
          "' appears twice; list its captions once");
  return json;
}

}  // namespace caption_detail

/// Reads {"clip": "text"}, {"clip": ["text", ...]}, or a list of objects with a clip id ("id", "clip", "file"
/// or "name") and a caption or list of captions ("caption", "text", "description", "captions" or "texts").
/// Throws Error, starting with `name`.
inline CaptionFile parse_caption_json(std::string_view text, std::string_view name) {
  namespace detail = caption_detail;
  CaptionFile out{std::string(name), {}};
  const detail::OrderedJson json = detail::parse_caption_document(without_byte_order_mark(text, name), name);
  require(json.is_object() || json.is_array(), name, ": found ", json.dump().substr(0, 40),
          ", expected {\"clip\": [\"caption\", ...]} or [{\"id\": \"clip\", \"caption\": \"...\"}]");
  if (json.is_array())
    detail::add_json_list(out, json);
  else
    for (const auto& [id, value] : json.items()) detail::add_json_captions(out, id, value);
  return out;
}

}  // namespace motiongan::motion
