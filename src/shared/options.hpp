// Options of the library's structs on the command line, and in the note of a run: all from their fields.
#pragma once
#include "motiongan/core/fields.hpp"
#include "shared/command.hpp"

namespace motiongan::command {

/// Adds an option to the verb for each field that has one, with its help, default and range. `group` is the
/// heading in --help for those that name none.
void add_options(CLI::App& verb, const FieldList& fields, const std::string& group);

/// The same for those fields whose keys are in `only`, or, where that is empty, are not in `without`.
struct OptionFilter {
  std::vector<std::string_view> only = {}, without = {};
};
void add_options(CLI::App& verb, const FieldList& fields, const std::string& group,
                 const OptionFilter& filter);

/// Refuses numbers outside a range; CLI11 itself would wrap a negative whole number around.
CLI::Validator in_range(const Range& range);

/// The fields as the text of a note: a JSON object by the names of their options.
std::string note_of(const FieldList& fields);

/// Takes from a note what the command line of `verb` does not give; `from` is the checkpoint, for errors.
/// `of_data` are the options that go with a folder of clips: if the command line gives other data, neither
/// they nor the data are taken.
void take_note(const FieldList& fields, const CLI::App& verb, const std::string& note, const fs::path& from,
               const std::vector<std::string_view>& of_data = {});

}  // namespace motiongan::command
