// Declarative options. A struct lists its members as fields (key, help text, permitted values); saved files,
// resume checks, validation and the command line all read that list.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "motiongan/core/error.hpp"

namespace motiongan {

/// The names of an enum's values. A function `enum_names(E)` next to the enum returns its table:
///
///     constexpr NameTable<Color, 2> enum_names(Color) { return {{{Color::red, "red"}, {Color::blue,
///     "blue"}}}; }
///
/// Older files store a value as its index in this table: append, never reorder.
template <class E, std::size_t n>
using NameTable = std::array<std::pair<E, const char*>, n>;

/// The name of an enum's value; "?" if it is not in the table.
template <class E>
const char* name_of(E value) {
  for (const auto& [candidate, name] : enum_names(value))
    if (candidate == value) return name;
  return "?";
}

/// The value called `name`. Throws Error, listing the names, if there is none; `what` names the option.
template <class E>
E enum_from(std::string_view name, std::string_view what) {
  std::string names;
  for (const auto& [value, candidate] : enum_names(E{})) {
    if (name == candidate) return value;
    names += (names.empty() ? "" : ", ") + std::string(candidate);
  }
  throw Error(what, " is \"", name, "\", expected one of ", names);
}

/// The interval of permitted numbers: both ends included, unless `low_open` excludes the lower one.
struct Range {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  bool low_open = false;  ///< `low` itself is not permitted

  static Range at_least(double low) { return {.low = low}; }
  static Range above(double low) { return {.low = low, .low_open = true}; }
  static Range between(double low, double high) { return {.low = low, .high = high}; }

  bool contains(double value) const {
    return (low_open ? value > low : value >= low) && value <= high;  // false for NaN
  }
  /// Whether there is an end at all.
  bool limits() const { return low > -std::numeric_limits<double>::infinity() || high < 1e300; }

  /// "at least 1", "above 0", "0 to 1".
  std::string text() const {
    if (high < 1e300) return concat(low, low_open ? " (excluded) to " : " to ", high);
    return concat(low_open ? "above " : "at least ", low);
  }
};

/// Name, help text and permitted values of a member of an options struct.
struct FieldInfo {
  std::string key;          ///< in files, e.g. "lambda_gp"
  std::string help;         ///< one line, for --help and for docs/options.md
  Range range = {};         ///< for numbers
  std::string option = {};  ///< on the command line; empty: "--" and the key with dashes; "-": none
  std::string type = {};    ///< value placeholder in --help; empty: from the member's type
  std::string group = {};   ///< heading in --help; empty: the struct's
  bool saved = true;        ///< whether it is written to files
  bool may_change = false;  ///< whether a resumed run may change it
  std::vector<std::size_t> choices = {};  ///< permitted whole numbers; empty: all in `range`
};

/// A value in force from `iteration` until the next stage begins.
struct ScheduleStage {
  std::size_t iteration = 0;  ///< the first one, counted from 0
  double value = 0;
  bool operator==(const ScheduleStage&) const = default;
};

/// Type-erased access to an enum or an optional enum by name.
struct EnumAccess {
  void* at;                                                     ///< the member
  std::string (*get)(const void*);                              ///< its name
  void (*set)(void*, std::string_view, std::string_view what);  ///< by name; `what`: its name in messages
  std::span<const char* const> names;                           ///< all of them
};

/// A member of an options struct with its description. Refers to the struct, which must outlive the field.
struct Field {
  /// What a member can be.
  using Access =
      std::variant<bool*, std::optional<bool>*, std::size_t*, double*, std::string*, std::filesystem::path*,
                   std::vector<std::string>*, std::vector<ScheduleStage>*, EnumAccess>;
  FieldInfo info;  ///< its key, help and range
  Access access;   ///< the member

  /// "--critic-steps"; "" if the command has no such option.
  std::string option() const {
    if (info.option == "-") return {};
    if (!info.option.empty()) return info.option;
    std::string name = "--" + info.key;
    for (char& c : name)
      if (c == '_') c = '-';
    return name;
  }

  /// The value as text, for error messages.
  std::string text() const {
    struct Print {
      std::string operator()(const bool* b) const { return *b ? "true" : "false"; }
      std::string operator()(const std::optional<bool>* b) const {
        return !*b ? "auto" : **b ? "true" : "false";
      }
      std::string operator()(const std::size_t* n) const { return std::to_string(*n); }
      std::string operator()(const double* x) const { return concat(*x); }
      std::string operator()(const std::string* s) const { return '"' + *s + '"'; }
      std::string operator()(const std::filesystem::path* p) const { return '"' + p->string() + '"'; }
      std::string operator()(const std::vector<std::string>* list) const {
        std::string out;
        for (const std::string& item : *list) out += (out.empty() ? "" : ",") + item;
        return '"' + out + '"';
      }
      std::string operator()(const std::vector<ScheduleStage>* stages) const {
        std::string out;
        for (const ScheduleStage& s : *stages)
          out += concat(out.empty() ? "" : ", ", s.value, " from ", s.iteration);
        return out;
      }
      std::string operator()(const EnumAccess& e) const { return '"' + e.get(e.at) + '"'; }
    };
    return std::visit(Print{}, access);
  }

  /// Whether both members have the same type and value.
  bool equals(const Field& other) const {
    const auto same = [&]<class T>(const T& mine) {
      const T& theirs = std::get<T>(other.access);
      if constexpr (std::is_pointer_v<T>)
        return *mine == *theirs;
      else
        return mine.get(mine.at) == theirs.get(theirs.at);
    };
    return access.index() == other.access.index() && std::visit(same, access);
  }

  /// Throws Error, naming the key, unless the value is finite, in its range and one of `choices`.
  void check() const {
    if (const auto* n = std::get_if<std::size_t*>(&access)) {
      require(info.range.contains(static_cast<double>(**n)), info.key, " is ", **n, ", expected ",
              info.range.text());
      bool permitted = info.choices.empty();
      std::string choices;
      for (const std::size_t choice : info.choices) {
        permitted = permitted || choice == **n;
        choices += concat(choices.empty() ? "" : " or ", choice);
      }
      require(permitted, info.key, " is ", **n, ", expected ", choices);
    } else if (const auto* x = std::get_if<double*>(&access)) {
      require(!info.range.limits() || info.range.contains(**x), info.key, " is ", **x, ", expected ",
              info.range.text());
      require(std::isfinite(**x), info.key, " is ", **x, ", expected a finite number");
    } else if (const auto* stages = std::get_if<std::vector<ScheduleStage>*>(&access)) {
      for (const ScheduleStage& stage : **stages)
        require(std::isfinite(stage.value), info.key, " from ", stage.iteration, " on is ", stage.value,
                ", expected a finite number");
    }
  }
};

/// The fields of an options struct, in declaration order.
class FieldList {
 public:
  /// Adds a member. It must outlive the list.
  /// \{
  void add(bool& member, FieldInfo info) { fields_.push_back({std::move(info), &member}); }
  void add(std::optional<bool>& member, FieldInfo info) { fields_.push_back({std::move(info), &member}); }
  void add(std::size_t& member, FieldInfo info) { fields_.push_back({std::move(info), &member}); }
  void add(double& member, FieldInfo info) { fields_.push_back({std::move(info), &member}); }
  void add(std::string& member, FieldInfo info) { fields_.push_back({std::move(info), &member}); }
  void add(std::filesystem::path& member, FieldInfo info) { fields_.push_back({std::move(info), &member}); }
  void add(std::vector<std::string>& member, FieldInfo info) {
    fields_.push_back({std::move(info), &member});
  }
  void add(std::vector<ScheduleStage>& member, FieldInfo info) {
    fields_.push_back({std::move(info), &member});
  }
  /// \}

  /// An enum, by the names in its table.
  template <class E>
  requires std::is_enum_v<E>
  void add(E& member, FieldInfo info) {
    fields_.push_back(
        {std::move(info),
         EnumAccess{&member,
                    [](const void* at) -> std::string { return name_of(*static_cast<const E*>(at)); },
                    [](void* at, std::string_view name, std::string_view what) {
                      *static_cast<E*>(at) = enum_from<E>(name, what);
                    },
                    names<E, false>()}});
  }
  /// An optional enum; an empty one is called "auto".
  template <class E>
  requires std::is_enum_v<E>
  void add(std::optional<E>& member, FieldInfo info) {
    using Optional = std::optional<E>;
    fields_.push_back(
        {std::move(info), EnumAccess{&member,
                                     [](const void* at) -> std::string {
                                       const auto& value = *static_cast<const Optional*>(at);
                                       return value ? name_of(*value) : "auto";
                                     },
                                     [](void* at, std::string_view name, std::string_view what) {
                                       auto& value = *static_cast<Optional*>(at);
                                       value.reset();
                                       if (name != "auto") value = enum_from<E>(name, what);
                                     },
                                     names<E, true>()}});
  }

  std::vector<Field>::const_iterator begin() const { return fields_.begin(); }
  std::vector<Field>::const_iterator end() const { return fields_.end(); }

  /// The field with this key, or null.
  const Field* find(std::string_view key) const {
    for (const Field& field : fields_)
      if (field.info.key == key) return &field;
    return nullptr;
  }

  /// Throws Error for the first value that is not permitted, see Field::check.
  void check() const {
    for (const Field& field : fields_) field.check();
  }

 private:
  template <class E, bool optional>
  static std::span<const char* const> names() {
    static const auto list = [] {
      constexpr auto table = enum_names(E{});
      std::array<const char*, table.size() + (optional ? 1 : 0)> out{};
      for (std::size_t i = 0; i < table.size(); ++i) out[i] = table[i].second;
      if constexpr (optional) out.back() = "auto";
      return out;
    }();
    return list;
  }

  std::vector<Field> fields_;
};

/// The fields of a struct with a member list_fields(FieldList&).
template <class Options>
FieldList fields_of(Options& options) {
  FieldList list;
  options.list_fields(list);
  return list;
}

/// Throws Error, naming the key, unless every value is permitted.
template <class Options>
void check_options(Options options) {
  fields_of(options).check();
}

}  // namespace motiongan
