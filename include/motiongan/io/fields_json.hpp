// Reads and writes options structs as JSON, from their field lists.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "motiongan/core/fields.hpp"
#include "motiongan/io/json_depth.hpp"

namespace motiongan::io {

namespace detail {

inline nlohmann::json field_to_json(const Field& field) {
  struct Write {
    nlohmann::json operator()(const bool* b) const { return *b; }
    nlohmann::json operator()(const std::optional<bool>* b) const {
      return *b ? nlohmann::json(**b) : nlohmann::json();
    }
    nlohmann::json operator()(const std::size_t* n) const { return *n; }
    nlohmann::json operator()(const double* x) const { return *x; }
    nlohmann::json operator()(const std::string* s) const { return *s; }
    nlohmann::json operator()(const std::filesystem::path* p) const { return p->string(); }
    nlohmann::json operator()(const std::vector<std::string>* list) const { return *list; }
    nlohmann::json operator()(const std::vector<ScheduleStage>* stages) const {
      nlohmann::json out = nlohmann::json::array();
      for (const ScheduleStage& stage : *stages) {
        nlohmann::json pair = nlohmann::json::array();
        pair.push_back(stage.iteration);
        pair.push_back(stage.value);
        out.push_back(std::move(pair));
      }
      return out;
    }
    nlohmann::json operator()(const EnumAccess& e) const { return e.get(e.at); }
  };
  return std::visit(Write{}, field.access);
}

/// Sets the member. Throws Error for a value of the wrong type. Older files store an enum as its index in the
/// table of names, which is accepted too.
inline void field_from_json(const Field& field, const nlohmann::json& json, const std::string& where) {
  struct Read {
    const Field& field;
    const nlohmann::json& json;
    const std::string& where;
    void expect(bool fits, const char* expected) const {
      require(fits, where, ": \"", field.info.key, "\" is ", json.dump(), ", expected ", expected);
    }
    std::size_t count(const nlohmann::json& value) const {
      expect(value.is_number_unsigned() || (value.is_number_integer() && value.get<std::int64_t>() >= 0),
             "a whole number of at least 0");
      return value.get<std::size_t>();
    }
    void operator()(bool* b) const {
      expect(json.is_boolean(), "true or false");
      *b = json.get<bool>();
    }
    void operator()(std::optional<bool>* b) const {
      expect(json.is_boolean() || json.is_null(), "true, false or null");
      b->reset();
      if (json.is_boolean()) *b = json.get<bool>();
    }
    void operator()(std::size_t* n) const { *n = count(json); }
    double number(const nlohmann::json& value, const char* expected) const {
      expect(value.is_number() && std::isfinite(value.get<double>()), expected);
      return value.get<double>();
    }
    void operator()(double* x) const { *x = number(json, "a finite number"); }
    void operator()(std::string* s) const {
      expect(json.is_string(), "a string");
      *s = json.get<std::string>();
    }
    void operator()(std::filesystem::path* p) const {
      expect(json.is_string(), "a string");
      *p = json.get<std::string>();
    }
    void operator()(std::vector<std::string>* list) const {
      expect(json.is_array(), "a list of strings");
      list->clear();
      for (const nlohmann::json& item : json) {
        expect(item.is_string(), "a list of strings");
        list->push_back(item.get<std::string>());
      }
    }
    void operator()(std::vector<ScheduleStage>* stages) const {
      expect(json.is_array(), "pairs of an iteration and a value");
      stages->clear();
      for (const nlohmann::json& stage : json) {
        const char* const pair = "pairs of an iteration and a value";
        expect(stage.is_array() && stage.size() == 2, pair);
        stages->push_back({count(stage[0]), number(stage[1], pair)});
      }
    }
    void operator()(const EnumAccess& e) const {
      if (json.is_string()) return e.set(e.at, json.get<std::string>(), concat(where, ": ", field.info.key));
      const std::size_t place = count(json);
      expect(place < e.names.size(), "a name");
      e.set(e.at, e.names[place], field.info.key);
    }
  };
  std::visit(Read{field, json, where}, field.access);
}

}  // namespace detail

/// A JSON object of all saved fields, by key.
inline nlohmann::json fields_to_json(const FieldList& fields) {
  nlohmann::json out = nlohmann::json::object();
  for (const Field& field : fields)
    if (field.info.saved) out[field.info.key] = detail::field_to_json(field);
  return out;
}
/// fields_to_json() as text.
inline std::string fields_to_text(const FieldList& fields) { return fields_to_json(fields).dump(); }

/// Parses JSON; the result is discarded() for a text that is none, or that nests too deeply.
inline nlohmann::json parse_json(const std::string& text) {
  if (nests_too_deeply(text)) return nlohmann::json::value_t::discarded;
  return nlohmann::json::parse(text, nullptr, false);
}

/// Parses a JSON object. Throws Error, starting with `where`, if `text` is anything else.
inline nlohmann::json parse_object(const std::string& text, const std::string& where) {
  nlohmann::json json = parse_json(text);
  require(json.is_object(), where, ": cannot be read, expected a JSON object",
          nests_too_deeply(text) ? concat(" that nests at most ", most_nested_json, " deep") : std::string());
  return json;
}

/// Sets the saved fields that the JSON object `text` contains. The others keep their values, so that older
/// files can lack newer options. Throws Error, starting with `where`, for a value of the wrong type.
inline void fields_from_text(const FieldList& fields, const std::string& text, const std::string& where) {
  const nlohmann::json json = parse_object(text, where);
  for (const Field& field : fields)
    if (const auto found = json.find(field.info.key); field.info.saved && found != json.end())
      detail::field_from_json(field, *found, where);
}

/// Whether two formats, as in files, are those of the same data. One written before units and axes were kept
/// has none to compare.
inline bool same_format(const std::string& then, const std::string& now) {
  if (then == now) return true;
  const nlohmann::json before = parse_json(then);
  nlohmann::json after = parse_json(now);
  if (!before.is_object() || !after.is_object()) return false;
  for (const char* key : {"unit_metres", "clips_up", "descriptions"})
    if (!before.contains(key)) after.erase(key);
  return before == after;
}

}  // namespace motiongan::io
