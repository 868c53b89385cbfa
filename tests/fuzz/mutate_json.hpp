// Mutations of JSON that keep it JSON: one value is exchanged for another one.
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "target.hpp"

namespace motiongan::fuzz {

namespace json_detail {

using Json = nlohmann::json;

inline std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// All values of the document, itself first; at most 2000.
inline std::vector<Json*> values_of(Json& document) {
  std::vector<Json*> out{&document};
  for (std::size_t i = 0; i < out.size() && out.size() < 2000; ++i)
    if (out[i]->is_structured())
      for (Json& below : *out[i]) out.push_back(&below);
  return out;
}

/// A value that a reader may not expect.
inline Json odd_value(Random& random) {
  static const Json values[] = {nullptr,
                                true,
                                false,
                                0,
                                1,
                                -1,
                                3,
                                0.5,
                                -0.0,
                                1e308,
                                5e-324,
                                65536,
                                4294967296,
                                INT64_MIN,
                                INT64_MAX,
                                UINT64_MAX,
                                "",
                                "x",
                                std::string("a\0b", 3),
                                Json::array(),
                                Json::object(),
                                Json::array({nullptr}),
                                Json::array({0, UINT64_MAX})};
  return values[below(std::size(values), random)];
}

inline std::string change_json(std::string_view text, const ChangeBytes& change, Random& random, int depth);

/// Changes a string, which may hold a JSON document in turn.
inline void change_string(Json& value, const ChangeBytes& change, Random& random, int depth) {
  const std::string text = value.get<std::string>();
  const bool nested = depth < 2 && (text.starts_with('{') || text.starts_with('['));
  value = nested ? change_json(text, change, random, depth + 1) : change(text);
}

inline void change_number(Json& value, Random& random) {
  const auto old = value.get<double>();
  const double changed[] = {old + 1, old - 1, -old, old * 2, old / 3, old * 1e6};
  const double x = changed[below(6, random)];
  value = x > -1e15 && x < 1e15 && below(3, random) > 0 ? Json(static_cast<std::int64_t>(x)) : Json(x);
}

inline void change_list(Json& value, const Json& other, Random& random) {
  if (value.empty() || below(3, random) == 0) {
    value.is_array() ? value.push_back(other) : value.update(Json{{"x", other}});
    return;
  }
  auto at = value.begin();
  std::advance(at, static_cast<std::ptrdiff_t>(below(value.size(), random)));
  if (below(2, random) == 0) {
    value.erase(at);
  } else if (value.is_array()) {
    const Json copy = *at;
    value.insert(at, copy);
  } else {
    const Json copy = *at;
    value[at.key() + "s"] = copy;
  }
}

/// Changes one value, within a string that holds JSON too; bytes where the text is not JSON.
inline std::string change_json(std::string_view text, const ChangeBytes& change, Random& random, int depth) {
  Json document = Json::parse(text, nullptr, false);
  if (document.is_discarded()) return change(text);
  const std::vector<Json*> values = values_of(document);
  Json& value = *values[below(values.size(), random)];
  const Json other = *values[below(values.size(), random)];
  switch (below(8, random)) {
    case 0:
      value = odd_value(random);
      break;
    case 1:
      value = other;
      break;
    case 2:
      value = Json::array({other});
      break;
    default:
      if (value.is_string())
        change_string(value, change, random, depth);
      else if (value.is_number())
        change_number(value, random);
      else if (value.is_structured())
        change_list(value, other, random);
      else
        value = odd_value(random);
  }
  return text_of(document);
}

}  // namespace json_detail

/// Changes one value of a JSON document, or, now and then, some of its bytes.
inline std::string mutate_json(std::string_view text, const ChangeBytes& change, Random& random) {
  if (below(5, random) == 0) return change(text);
  return json_detail::change_json(text, change, random, 0);
}

}  // namespace motiongan::fuzz
