#include "shared/options.hpp"

#include "motiongan/io/fields_json.hpp"

namespace motiongan::command {
namespace {

/// Adds the option of one field.
struct AddOption {
  CLI::App& verb;
  const Field& field;
  std::string name = field.option();

  CLI::Option* operator()(bool* member) const {
    // A flag that is on by default also gets a --no- form.
    return verb.add_flag(*member ? with_no() : name, *member,
                         field.info.help + (*member ? " [on]" : " [off]"));
  }
  CLI::Option* operator()(std::optional<bool>* member) const {
    return verb.add_flag_function(
        with_no(), [member](std::int64_t count) { *member = count > 0; }, field.info.help);
  }
  CLI::Option* operator()(std::size_t* member) const {
    CLI::Option* option = number(*member);
    if (!field.info.choices.empty()) option->check(CLI::IsMember(field.info.choices));
    return option;
  }
  CLI::Option* operator()(double* member) const { return number(*member); }
  CLI::Option* operator()(std::string* member) const {
    return verb.add_option(name, *member, field.info.help);
  }
  CLI::Option* operator()(std::filesystem::path* member) const {
    return verb.add_option_function<std::string>(
        name, [member](const std::string& text) { *member = text; }, field.info.help);
  }
  CLI::Option* operator()(std::vector<std::string>* member) const {
    return verb.add_option(name, *member, field.info.help)->delimiter(',');
  }
  CLI::Option* operator()(std::vector<ScheduleStage>*) const { return nullptr; }  // not on the command line
  CLI::Option* operator()(const EnumAccess& access) const {
    const std::vector<std::string> names(access.names.begin(), access.names.end());
    return verb
        .add_option_function<std::string>(
            name, [access, what = name](const std::string& text) { access.set(access.at, text, what); },
            field.info.help)
        ->check(CLI::IsMember(names))
        ->default_str(access.get(access.at));
  }

 private:
  std::string with_no() const { return name + ",!--no-" + name.substr(2); }
  template <class T>
  CLI::Option* number(T& member) const {
    constexpr bool whole = std::is_same_v<T, std::size_t>;
    const Range& range = field.info.range;
    return verb.add_option(name, member, field.info.help)
        ->capture_default_str()
        ->check(in_range(whole && !range.limits() ? Range::at_least(0) : range, whole));
  }
};

bool contains(const std::vector<std::string_view>& list, std::string_view name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

}  // namespace

bool given(const CLI::App& verb, const std::string& name) {
  const CLI::Option* const option = verb.get_option_no_throw(name);
  return option != nullptr && option->count() > 0;
}

CLI::Validator in_range(const Range& range, bool whole) {
  return {[range, whole](std::string& text) {
            const std::optional<double> value = finite_number(text);
            const std::string limits = range.limits() ? range.text() : "";
            if (value && !range.contains(*value)) return concat("expected ", limits, ", not ", text);
            if (value && (!whole || whole_number(text))) return std::string();
            return concat("expected ", expected_number(text, whole), limits.empty() ? "" : ", ", limits,
                          ", not ", text.empty() ? "nothing" : text);
          },
          ""};
}

CLI::Validator not_negative() { return in_range(Range::at_least(0)); }
CLI::Validator positive() { return in_range(Range::above(0)); }

void add_options(CLI::App& verb, const FieldList& fields, const std::string& group,
                 const OptionFilter& filter) {
  for (const Field& field : fields) {
    const std::string_view key = field.info.key;
    if (field.option().empty() || (!filter.only.empty() && !contains(filter.only, key)) ||
        contains(filter.without, key))
      continue;
    CLI::Option* const option = std::visit(AddOption{verb, field}, field.access);
    if (option == nullptr) continue;
    option->group(field.info.group.empty() ? group : field.info.group);
    if (!field.info.type.empty()) option->type_name(field.info.type);
  }
}

void add_options(CLI::App& verb, const FieldList& fields, const std::string& group) {
  add_options(verb, fields, group, {});
}

std::string note_of(const FieldList& fields) {
  nlohmann::json out = nlohmann::json::object();
  for (const Field& field : fields)
    if (const std::string name = field.option(); !name.empty()) out[name] = io::detail::field_to_json(field);
  return out.dump();
}

void take_note(const FieldList& fields, const CLI::App& verb, const std::string& note, const fs::path& from,
               const std::vector<std::string_view>& of_data) {
  const nlohmann::json kept = io::parse_object(note, from.string() + ": the options of the run");
  const bool other_data = given(verb, "FOLDER") || given(verb, "--procedural");
  for (const Field& field : fields) {
    const std::string name = field.option();
    const bool is_data = name == "FOLDER" || name == "--procedural" || contains(of_data, name);
    if (name.empty() || given(verb, name) || (is_data && other_data)) continue;
    const auto found = kept.find(name);
    if (found == kept.end()) continue;  // the run is older than the option
    io::detail::field_from_json(field, *found, from.string() + ": the options of the run");
  }
}

}  // namespace motiongan::command
